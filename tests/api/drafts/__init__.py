"""Tests over HTTP of drafts."""
