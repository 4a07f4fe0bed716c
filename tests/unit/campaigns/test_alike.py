"""Texts that look the same are the same, whatever shows nothing in them; others are not."""

from __future__ import annotations

import pytest

from backend.requirements.against import _fold
from backend.signoffs.persons import folded
from campaigns.alike import plain

SHOWS_NOTHING = ["\ufe0f", "\u034f", "\u3164", "\u115f", "\u17b4", "\u180b", "\uffa0", "\u200b", "\u00ad", "\U000e0101"]


@pytest.mark.parametrize("mark", SHOWS_NOTHING, ids=lambda mark: f"U+{ord(mark):04X}")
def test_what_shows_nothing_makes_no_difference(mark: str) -> None:
    assert plain(f"RE{mark}Q-1{mark}") == plain("req-1")
    assert _fold(f"{mark}REQ-1") == _fold("REQ\u20111")
    assert folded(f"Grace{mark} Hopper{mark}") == folded("grace hopper")


def test_other_texts_differ() -> None:
    texts = ["REQ-1", "REQ-2", "REQ-10", "RÉQ-1", "R-1"]
    assert len({_fold(text) for text in texts}) == len(texts)
