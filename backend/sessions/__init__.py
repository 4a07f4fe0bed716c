"""Signing in with the login link, and signing out."""
