"""Tests over HTTP of proposals."""
