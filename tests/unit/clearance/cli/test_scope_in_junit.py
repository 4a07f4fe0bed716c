"""Every test case of JUnit that states a verdict also states the scope in which it holds."""

from __future__ import annotations

from unittest import mock
from xml.etree import ElementTree as Xml

import pytest

from campaigns.results import Verdict
from campaigns.results.verdict import VerdictWord
from clearance.cli._ended import Case, EndedRun, Source
from clearance.cli._junit import junit
from tests import results

BOUNDS = "vehicle.m: 4 to 6 kg"
FOUND = Case("F1", 0.3, -0.2, {"vehicle.m": 6.0})


def ended(word: VerdictWord) -> EndedRun:
    """A run with one requirement."""
    violated = word == "violated"
    scope = results.statement(BOUNDS)
    verdict: Verdict = results.verdict(word, f"It is {word}.", 1.4, 0.3 if violated else 1.3, holds_for=scope)
    return EndedRun(
        run="R-0007", campaign="Case", state="done", link="http://x", verdict=verdict, quantity="d_min", unit="m",
        threshold=0.5, findings=(FOUND,) if violated else (), requirements=("SYS-1",), source=Source("c.yaml", ""),
    )  # fmt: skip


@pytest.mark.parametrize("accepted", [False, True])
@pytest.mark.parametrize("word", ["cleared", "violated", "inconclusive"])
def test_each_case_of_a_verdict_has_its_scope(word: VerdictWord, accepted: bool) -> None:
    with mock.patch.object(EndedRun, "accepted", accepted and word == "violated"):
        suite = Xml.fromstring(junit(ended(word)))
    cases = [case for case in suite.iter("testcase") if not str(case.get("name")).startswith(("check", "baseline"))]
    assert [case.get("name") for case in cases] == ["verdict", "criterion: d_min", "requirement: SYS-1"]
    for case in cases:
        assert any(BOUNDS in part for one in case.iter() for part in (one.get("message"), one.text) if part), case
