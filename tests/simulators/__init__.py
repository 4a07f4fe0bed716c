"""Simulators of a temporary package, as an operator would install one. Start reading at `package`."""
