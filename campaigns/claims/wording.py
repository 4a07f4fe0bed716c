"""The version of the sentences of results, which are no part of the code of a run."""

WORDING = 4
"""Raised when a sentence of a result changes: the audit makes sentences again only where the same templates made them.
Stored with the versions of a run since 2."""
