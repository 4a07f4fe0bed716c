"""Unit tests of engine/search."""
