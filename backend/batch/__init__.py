"""Several answers to one request: what a page shows first."""
