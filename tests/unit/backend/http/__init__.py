"""Unit tests of backend/http."""
