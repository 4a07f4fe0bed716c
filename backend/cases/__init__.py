"""What-if of a simulator: one case of a stored run, evaluated on request with other parameters."""
