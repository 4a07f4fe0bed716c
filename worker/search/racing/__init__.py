"""The parts of contrast racing, compiled; the method is `worker.search.methods.contrast_racing`."""
