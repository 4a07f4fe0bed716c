"""Unit tests of running/catalogue."""
