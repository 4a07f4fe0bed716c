"""Tests over HTTP of signoffs."""
