"""Tests over HTTP of exports."""
