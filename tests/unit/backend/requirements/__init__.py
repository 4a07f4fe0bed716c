"""Unit tests of backend/requirements."""
