"""Kernels that components share: aerodynamics, autopilot, fields, conflict resolution, shapes, paths."""
