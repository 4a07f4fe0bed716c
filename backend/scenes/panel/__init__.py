"""The viewer's panel: its tabs and what they show."""
