"""Tests over HTTP of access."""
