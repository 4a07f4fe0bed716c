"""Regions of attraction of polynomial closed loops by sums of squares: a measurement, not a part of the product."""
