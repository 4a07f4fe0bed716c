"""Unit tests of engine/stages."""
