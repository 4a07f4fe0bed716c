"""Unit tests of engine/systems."""
