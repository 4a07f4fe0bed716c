"""Unit tests of clearance."""
