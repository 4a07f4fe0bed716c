"""Tests over HTTP of flights."""
