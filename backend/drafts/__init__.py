"""Campaigns in preparation, stored as their original text."""
