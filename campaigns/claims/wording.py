"""The version of the sentences of results, which are no part of the code of a run."""

from __future__ import annotations

from campaigns.version import VERSION
from campaigns.versions import Versions

WORDING = 24
"""Raised when a sentence of a result changes: the audit makes sentences again only where the same templates made them.
Stored with the versions of a run since 2."""

CLEARING = 24
"""The version since which a run is cleared by the rules of today: raised to `WORDING` with each rule that can withdraw
"cleared". The audit has it a second time."""


def reworded(versions: Versions) -> str:
    """Whose templates made the sentences, if not those of this installation; empty otherwise."""
    if versions.clearance not in (None, VERSION):
        return f"clearance {versions.clearance}"
    return "" if versions.wording == WORDING else "an earlier version of the templates"
