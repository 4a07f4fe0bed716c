"""The campaign and how it is read."""
