"""How a run is carried: runner, store, resumption, provenance, source files. Start reading at `runner`."""
