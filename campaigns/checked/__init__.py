"""Checks whether a campaign can be run: validation against the catalogue, limits and computing effort."""
