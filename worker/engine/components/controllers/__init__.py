"""One file, one controller."""
