"""What every connection and every request passes before an endpoint: limits, security headers, HEAD."""
