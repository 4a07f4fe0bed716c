"""Sweeps: one campaign with several values of a fixed parameter, launched, shown and cancelled together."""
