"""The service over HTTP: a real server on a free port, a real database."""
