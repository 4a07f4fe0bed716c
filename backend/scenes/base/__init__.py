"""Shared by all packages of the 3D view: address, the run's setting, flights, axes, colours, and parts."""
