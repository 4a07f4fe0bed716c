"""Simulations on demand: a child process answers one case at a time, the newest request first."""
