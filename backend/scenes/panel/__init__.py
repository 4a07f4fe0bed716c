"""The tabs of the viewer's panel and what they show."""
