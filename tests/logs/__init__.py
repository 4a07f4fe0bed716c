"""Readers of flight logs, on logs that the tests write."""
