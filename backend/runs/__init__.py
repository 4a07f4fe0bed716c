"""Submitting, listing, watching and cancelling runs."""
