"""A run as files: JSON, evaluations and flights as CSV, flights as a MAT-file."""
