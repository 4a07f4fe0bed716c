"""Unit tests of running/reproduce."""
