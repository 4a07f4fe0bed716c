"""The audit trail, for reviewers and administrators: in pages, and as a file."""
