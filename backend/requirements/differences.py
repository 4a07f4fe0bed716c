"""Texts of requirements in the audit trail: their lengths and digests, and what has changed as a short excerpt.

A text has up to 20,000 characters; a trail that held all of them could be filled by one user.
"""

from __future__ import annotations

import difflib
import hashlib
from collections.abc import Mapping

LONGEST = 500
"""Characters of an excerpt."""
_CUT = " …"


def stated_text(text: str) -> Mapping[str, object]:
    """What a row states about one text."""
    return {"text": {**_measured(text), "begins": _cut(text)}}


def changed_text(before: str, after: str) -> Mapping[str, object]:
    """What a row states about a change."""
    return {"before": _measured(before), "text": _measured(after), "difference": _difference(before, after)}


def _measured(text: str) -> Mapping[str, object]:
    return {"characters": len(text), "sha256": hashlib.sha256(text.encode()).hexdigest()}


def _difference(before: str, after: str) -> str:
    """The differing lines as a unified difference; the lines begin where the texts first differ if they are long."""
    lines = (before.splitlines() or [""], after.splitlines() or [""])
    if max(len(line) for some in lines for line in some) > LONGEST // 2:
        same = next(
            (i for i, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), min(map(len, (before, after)))
        )
        start = max(0, same - 40)
        half = LONGEST // 2 - 4
        return f"- {_cut(before[start:], half)}\n+ {_cut(after[start:], half)}"
    made = list(difflib.unified_diff(*lines, n=0, lineterm=""))[2:]
    return _cut("\n".join(made))


def _cut(text: str, longest: int = LONGEST) -> str:
    return text if len(text) <= longest else text[: longest - len(_CUT)] + _CUT
