"""One file, one obstacle."""
