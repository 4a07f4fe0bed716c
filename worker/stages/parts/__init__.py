"""What stages share: the driver, the store, samples, findings, confirmation. Start reading at `base.drive`."""
