"""Regions of attraction: search, rounding, simulation."""
