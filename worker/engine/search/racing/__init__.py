"""The parts of contrast racing, compiled; the method is `worker.engine.search.methods.contrast_racing`."""
