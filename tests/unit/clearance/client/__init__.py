"""Unit tests of clearance/client."""
