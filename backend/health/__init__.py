"""The health check, the only endpoint without authentication."""
