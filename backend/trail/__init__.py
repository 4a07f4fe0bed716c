"""The audit trail, for administrators: in pages, and as a file."""
