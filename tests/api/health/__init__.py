"""Of the health checks and metrics."""
