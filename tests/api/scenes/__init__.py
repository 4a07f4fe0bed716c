"""Tests over HTTP of scenes."""
