"""Preview: the nominal flight of a campaign that is being edited."""
