"""The identity of what a run is evaluated with, as one digest of the code that its campaign uses."""
