"""Unit tests of running/runs."""
