"""Unit tests of clearance/cli."""
