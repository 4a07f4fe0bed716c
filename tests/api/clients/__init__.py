"""Tests over HTTP of clients."""
