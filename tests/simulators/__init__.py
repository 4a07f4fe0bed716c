"""Simulators of a temporary package, as an operator would install one."""
