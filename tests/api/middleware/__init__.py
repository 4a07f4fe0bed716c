"""Tests over HTTP of middleware."""
