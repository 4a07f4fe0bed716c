"""Unit tests of backend/results."""
