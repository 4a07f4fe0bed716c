"""Tests over HTTP of provider."""
