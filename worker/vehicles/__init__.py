"""One file, one vehicle."""
