"""Unit tests of clearance/function."""
