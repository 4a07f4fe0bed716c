"""One file, one criteria."""
