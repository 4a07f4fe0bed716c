"""Shared parts of the stages: the driver, the store, samples, findings, confirmation."""
