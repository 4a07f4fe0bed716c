"""Unit tests of running/examination."""
