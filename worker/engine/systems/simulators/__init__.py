"""Simulators of other packages as systems. Start reading at `simulated`."""
