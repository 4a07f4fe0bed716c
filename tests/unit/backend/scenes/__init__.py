"""Unit tests of backend/scenes."""
