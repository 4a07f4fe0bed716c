"""Tests over HTTP of several answers to one request."""
