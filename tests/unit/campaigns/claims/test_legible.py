"""Text of others on a terminal: nothing that it would obey, and every number as it is written."""

from __future__ import annotations

import pytest

from campaigns.claims.legible import legible
from campaigns.claims.numbers import count

BAD = ["\x1b[2J", "\x07", "\u202e", "\u2028", "\u2029", "\ud800", "\x9b", "\r", "\n", "\ue000"]


@pytest.mark.parametrize("bad", BAD, ids=ascii)
def test_what_a_terminal_obeys_is_replaced(bad: str) -> None:
    shown = legible(f"a{bad}b")
    assert bad[0] not in shown
    assert shown.startswith("a\N{REPLACEMENT CHARACTER}")
    assert legible(f"a{bad}b", bad[0]) == f"a{bad}b"


def test_numbers_and_words_stay() -> None:
    text = f"{count(3375)} evaluations, \u22120.008 m, d\u00a0= 1, \u00b1 5 \u2030, \u738b"
    assert "\u202f" in text
    assert legible(text) == text
