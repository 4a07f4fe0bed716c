"""Tests over HTTP of results."""
