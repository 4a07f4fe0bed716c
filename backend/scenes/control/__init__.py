"""How a browser comes to its viewer, how the page steers it, and who flies for it."""
