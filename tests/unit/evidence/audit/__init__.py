"""Unit tests of evidence/audit."""
