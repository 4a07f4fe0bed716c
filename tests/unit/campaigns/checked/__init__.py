"""Unit tests of campaigns/checked."""
