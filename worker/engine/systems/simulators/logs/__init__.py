"""Distances from the logs of flights and drives, for adapters of simulators."""
