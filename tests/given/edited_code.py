"""The code digest of a campaign as if one module of this installation had another text."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

from campaigns import Campaign
from worker.running.runs import identity, sources

COMPUTED = (
    *(identity.loaded, identity._reached, identity.closure, identity.code_parts),
    *(identity._systems, identity._guests),
)
"""What is computed once of the texts."""


def digest_with(asked: Campaign, module: str, old: bytes, new: bytes) -> str:
    """The code digest of the campaign with one text of one module replaced."""
    content = sources.LOADED.files[module]
    assert old in content, f"{module} has no {old!r}"
    files = {**sources.LOADED.files, module: content.replace(old, new)}
    try:
        with patch.object(sources, "LOADED", replace(sources.LOADED, files=files)):
            forget()
            return identity.code(asked).digest
    finally:
        forget()


def forget() -> None:
    """Compute all of it again."""
    for each in COMPUTED:
        each.cache_clear()
