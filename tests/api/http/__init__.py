"""Tests over HTTP of http."""
