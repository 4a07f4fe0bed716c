"""What the audit trail states about texts of requirements: lengths, digests, a short difference."""

from __future__ import annotations

import hashlib
import json

import pytest

from backend.requirements.service import LONGEST, changed_text, stated_text


def test_a_text_is_stated_by_length_digest_and_beginning() -> None:
    text = "Keep 0.5 m. " * 1000
    stated = stated_text(text)["text"]
    assert isinstance(stated, dict)
    assert (stated["characters"], stated["sha256"]) == (len(text), hashlib.sha256(text.encode()).hexdigest())
    assert text.startswith(stated["begins"].removesuffix(" …"))
    assert len(stated["begins"]) <= LONGEST


def test_a_change_is_stated_by_its_lines() -> None:
    before, after = "one\ntwo\nthree", "one\n2\nthree"
    assert changed_text(before, after)["difference"] == "@@ -2 +2 @@\n-two\n+2"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("x" * 20_000, "x" * 19_000 + "y" * 1000),
        ("a\n" * 9999, "b\n" * 9999),
        ("", "x" * 20_000),
        ("x" * 900, "x" * 901),
    ],
    ids=["one long line", "many lines", "from nothing", "one letter more"],
)
def test_a_row_is_short_whatever_changed(before: str, after: str) -> None:
    changed = changed_text(before, after)
    assert len(json.dumps(changed)) < 2000
    difference = str(changed["difference"])
    assert len(difference) <= LONGEST + 8
    assert after[-1] in difference


def test_a_change_at_the_end_of_a_long_line_is_seen() -> None:
    changed = str(changed_text("x" * 5000 + " 0.5 m", "x" * 5000 + " 0.4 m")["difference"])
    assert "0.5 m" in changed
    assert "0.4 m" in changed
