"""What `clearance component new` writes: one whole component of each kind, to be edited. Each is examined by a test."""
