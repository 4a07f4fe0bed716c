"""Unit tests of engine/problem."""
