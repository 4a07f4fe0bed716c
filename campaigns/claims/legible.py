"""Text of others, such as names and labels, for a terminal or a picture: without control characters."""

from __future__ import annotations

from unicodedata import category

REPLACEMENT = "\N{REPLACEMENT CHARACTER}"


def legible(text: str, kept: str = "") -> str:
    """The text with every control, format, surrogate and line-separating character replaced, except those `kept`.

    `str.isprintable` would also replace the narrow spaces in numbers.
    """
    return "".join(c if c in kept or not _obeyed(c) else REPLACEMENT for c in text)


def _obeyed(character: str) -> bool:
    kind = category(character)
    return kind.startswith("C") or kind in ("Zl", "Zp")
