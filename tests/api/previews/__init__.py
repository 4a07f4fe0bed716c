"""Tests over HTTP of previews."""
