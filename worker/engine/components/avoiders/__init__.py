"""One file, one avoider."""
