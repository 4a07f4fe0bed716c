"""Tests over HTTP of cases."""
