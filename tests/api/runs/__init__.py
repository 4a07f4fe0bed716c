"""Tests over HTTP of runs."""
