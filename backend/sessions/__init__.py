"""Signing in by the login link, and out."""
