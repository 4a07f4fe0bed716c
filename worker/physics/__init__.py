"""Plain kernels that components share: aerodynamics, autopilot, fields, conflict resolution, shapes, paths."""
