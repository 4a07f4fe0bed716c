"""What a monitoring system reads of the service: GET /metrics."""
