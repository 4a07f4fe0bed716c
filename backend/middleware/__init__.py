"""Middleware of all connections and requests: limits, security headers, HEAD."""
