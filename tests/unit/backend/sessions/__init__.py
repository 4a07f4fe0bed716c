"""Unit tests of backend/sessions."""
