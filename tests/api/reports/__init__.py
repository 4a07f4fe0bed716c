"""Tests over HTTP of reports."""
