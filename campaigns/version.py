"""The version of Clearance, as `pyproject.toml` states it, and that of the sentences of results."""

VERSION = "0.1.0"
WORDING = 4
"""Raised when a sentence of a result changes: the audit makes sentences again only where the same templates made them.
Stored with the versions of a run since 2."""
