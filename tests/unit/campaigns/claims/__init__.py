"""Unit tests of campaigns/claims."""
