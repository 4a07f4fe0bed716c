"""Tests over HTTP of users."""
