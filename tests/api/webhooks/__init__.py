"""Tests over HTTP of webhooks."""
