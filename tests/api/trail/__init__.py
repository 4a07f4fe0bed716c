"""Tests over HTTP of trail."""
