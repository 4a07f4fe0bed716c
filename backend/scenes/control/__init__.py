"""How a browser comes to its viewer, and how the page steers it."""
