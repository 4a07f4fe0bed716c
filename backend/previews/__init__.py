"""The nominal flight of a campaign that is still being edited."""
