"""Simulators of other packages as systems."""
