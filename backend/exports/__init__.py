"""Export of a run: JSON, evaluations and flights as CSV, flights as a MAT-file."""
