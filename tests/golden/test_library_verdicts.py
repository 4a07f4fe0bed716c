"""The campaigns of the library keep the verdicts of the stored table; `make library-verdicts` writes it again."""

from __future__ import annotations

import json

import pytest

from campaigns import library
from tools.library_verdicts import FILE, ran

KNOWN = json.loads(FILE.read_text(encoding="utf-8"))


def test_every_campaign_has_a_verdict() -> None:
    assert list(KNOWN) == list(library())


@pytest.mark.nightly
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("name", library())
def test_the_verdict_is_as_stored(name: str) -> None:
    found, known = ran(name), KNOWN[name]
    apart = {"margin": None, "evaluations": None}
    assert found | apart == known | apart
    assert found["margin"] == pytest.approx(known["margin"], rel=1e-3, abs=1e-6)
    made, stored = (sum(one["evaluations"].values()) for one in (found, known))
    assert made == pytest.approx(stored, rel=0.1), "searches depend on the last bits of every evaluation"
