"""Unit tests of running/processes."""
