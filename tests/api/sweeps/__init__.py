"""Tests over HTTP of sweeps."""
