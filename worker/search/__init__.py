"""The search methods, one file each, found by presence. Imports nothing of ours; start reading at `base.Method`."""
