"""Is the service up: the one open endpoint."""
