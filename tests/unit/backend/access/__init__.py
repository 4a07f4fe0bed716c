"""Unit tests of backend/access."""
