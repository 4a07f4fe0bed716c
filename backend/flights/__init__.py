"""One flight of a stored run, simulated on request with other parameters: the what-if."""
