"""Unit tests of engine/physics."""
