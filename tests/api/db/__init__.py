"""Tests over HTTP of db."""
