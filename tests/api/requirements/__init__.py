"""Tests over HTTP of requirements."""
