"""Shared parts of the stages: the driver, the store, samples, findings, confirmation. Start reading at `base.drive`."""
