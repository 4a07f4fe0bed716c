"""Regions of attraction of polynomial closed loops, certified by sums of squares."""
