"""Writes the text that stands between the components of a scenario and the loop. Start reading at `written`."""
