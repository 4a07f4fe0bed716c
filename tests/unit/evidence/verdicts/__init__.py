"""Unit tests of evidence/verdicts."""
