"""Unit tests of running."""
