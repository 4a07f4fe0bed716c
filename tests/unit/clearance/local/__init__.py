"""Unit tests of clearance/local."""
