"""Unit tests of backend/db."""
