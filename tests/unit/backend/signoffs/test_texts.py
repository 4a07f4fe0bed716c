"""A sign-off is valid for the text that was signed alone, whatever the campaign states and whatever is registered."""

from __future__ import annotations

import itertools

import pytest

from backend.signoffs.texts import Texts

WORDS = ("", "Keep 5 m.", "Keep 4 m.")


@pytest.mark.parametrize(("stated", "signed", "now"), list(itertools.product(WORDS, repeat=3)))
def test_a_sign_off_is_valid_for_the_signed_text_alone(stated: str, signed: str, now: str) -> None:
    texts = Texts({"SYS-1": now}, {"SYS-1": 1.0}, {1: {"SYS-1": stated}})
    suspect = list(texts.changes(1, "SYS-1", {"SYS-1": signed}, 2.0))
    assert bool(suspect) == (signed != now or stated not in ("", now))
