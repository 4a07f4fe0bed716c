"""Connects a browser to its viewer, and lets the page control it."""
