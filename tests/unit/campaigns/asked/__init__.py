"""Unit tests of campaigns/asked."""
