"""Texts that a reader takes for the same: one form of characters, without those that show nothing.

Unicode Standard Annex 15 (NFKC); Unicode Character Database, property Default_Ignorable_Code_Point.
"""

from __future__ import annotations

import unicodedata

_INVISIBLE = (
    (0x34F, 0x34F), (0x115F, 0x1160), (0x17B4, 0x17B5), (0x180B, 0x180F), (0x3164, 0x3164), (0xFE00, 0xFE0F),
    (0xFFA0, 0xFFA0), (0xE0000, 0xE0FFF),
)  # fmt: skip
"""Those of the property that are neither controls nor format characters."""


def plain(text: str) -> str:
    """The text in the form in which equal-looking characters are equal, letters in one case."""
    shown = (c for c in text if not any(first <= ord(c) <= last for first, last in _INVISIBLE))
    seen = "".join(c for c in shown if unicodedata.category(c) not in ("Cc", "Cf"))
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", seen).casefold())
