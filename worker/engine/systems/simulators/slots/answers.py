"""JSON that a simulator wrote: what cannot be read has a sentence, which quotes it.

Only the standard library is imported: the process of a slot loads it.
"""

from __future__ import annotations

import json
import re
from typing import Any

NAMED = re.compile(rb"""["'](?:results|error|excluded)["']\s*:""")
"""What an answer has and ordinary output has not."""
NUMBERED = re.compile(rb'"id"\s*:\s*(\d{1,18})\b')
SHOWN = 160
"""Characters of it that are quoted."""


class UnreadableAnswerError(ValueError):
    """What was written is not JSON, or states a name twice; `sentence` states how."""

    def __init__(self, sentence: str, twice: bool) -> None:
        super().__init__(sentence)
        self.sentence, self.twice = sentence, twice


def parsed(text: bytes, what: str) -> Any:
    """The value; raises `UnreadableAnswerError`. what: its name in the sentence."""

    def once(pairs: list[tuple[str, Any]]) -> Any:
        found = dict(pairs)
        if len(found) < len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            raise UnreadableAnswerError(f"{what} states {twice!r:.60} twice, so that its value is not known", True)
        return found

    try:
        return json.loads(text, object_pairs_hook=once)
    except UnreadableAnswerError:
        raise
    except RecursionError:
        why = "nested too deeply"
    except ValueError as error:  # also text that is not UTF-8
        why = str(error)
    shown = text.decode(errors="replace").strip()
    shown = shown if len(shown) <= SHOWN else f"{shown[:SHOWN]}..."
    raise UnreadableAnswerError(f"{what} is not JSON ({why}): {shown}", False)


def of_line(text: bytes) -> dict[str, Any] | None:
    """A line that is a JSON object, and None for ordinary output. A line that is an answer but cannot be read is one
    that reports this as its error: waiting for another answer would be in vain."""
    if not text.lstrip().startswith(b"{"):
        return None
    try:
        value = parsed(text, "its answer")
    except UnreadableAnswerError as error:
        if not (error.twice or NAMED.search(text)):
            return None
        number = NUMBERED.search(text)
        return {"error": error.sentence, **({"id": int(number[1])} if number else {})}
    return value if isinstance(value, dict) else None
