"""Unit tests of campaigns/results."""
