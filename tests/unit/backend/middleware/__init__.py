"""Unit tests of backend/middleware."""
