"""Unit tests of backend/signoffs."""
