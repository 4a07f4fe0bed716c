"""What-if: one flight of a stored run, simulated on request with other parameters."""
