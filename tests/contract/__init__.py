"""Contracts of all components and methods, which are found by presence."""
