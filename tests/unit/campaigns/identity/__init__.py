"""Unit tests of campaigns/identity."""
