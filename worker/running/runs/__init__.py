"""How a run is executed: runner, store, resumption, provenance, source files."""
