"""Tests over HTTP of workers."""
