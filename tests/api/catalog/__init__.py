"""Tests over HTTP of catalog."""
