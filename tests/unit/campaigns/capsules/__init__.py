"""Unit tests of campaigns/capsules."""
