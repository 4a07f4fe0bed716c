"""Tests over HTTP of trends."""
