"""A mistake in the file of a component, as one sentence with its line."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class Mistake(Exception):
    """What is written there, what is expected and what to do, in one sentence; the line in the file, 0 if unknown."""

    def __init__(self, text: str, line: int | None = 0) -> None:
        super().__init__(text)
        self.text, self.line = text, line or 0


def meant(name: str, names: Iterable[str], otherwise: str = "") -> str:
    """The close name as a question that ends a sentence; without one other advice, by default the names themselves."""
    names = list(names)
    close = difflib.get_close_matches(name, names, n=1)
    return f"did you mean {close[0]!r}?" if close else otherwise or f"choose one of: {', '.join(names)}"


def listed(names: Iterable[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    *first, last = list(names)
    return f"{', '.join(first)} and {last}" if first else last
