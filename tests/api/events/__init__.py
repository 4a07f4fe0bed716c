"""Tests over HTTP of events."""
