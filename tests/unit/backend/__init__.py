"""Unit tests of backend."""
