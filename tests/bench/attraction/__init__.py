"""Regions of attraction of a loop whose region is known: how much of it the product certifies."""
