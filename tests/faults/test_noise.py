"""Simulators that do not repeat: what is measured, what may be claimed, and that none is cleared by luck."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results import NominalResult, Verdict
from campaigns.results.nominal import Measured
from tests.audited import audited
from tests.simulators.adversaries import ADVERSARIES, adversary
from worker.runs.runner import execute
from worker.runs.store import MemoryStore

REPEATS = {"repeats": {"count": 5}}


def campaign(threshold: float = 1.0, certify: int = 120, **simulator: Any) -> Campaign:
    methods = [{"method": name, "evaluations": 150} for name in ("direct", "differential_evolution")]
    return load_document(
        {
            "name": "Adversary",
            "simulator": {"name": "adversary"} | simulator,
            "uncertain": {f"simulator.{name}": {"low": 0, "high": 1} for name in "ab"},
            "criterion": {"result": "d", "threshold": threshold},
            "agreement": 0.2,
            "stages": {
                "sensitivity": {"points": 5},
                "search": methods,
                "certify": {"samples": certify},
                "findings": {"evaluations": 300, "at_most": 2},
                "validate": {"neighbours": 20},
            },
        }
    )


def ran(asked: Campaign) -> tuple[Verdict, MemoryStore]:
    store = MemoryStore()
    verdict = execute(asked, store, threads=1)
    audited(store, asked)
    return verdict, store


def measured(store: MemoryStore) -> Measured:
    result = store.stages[0].result
    assert isinstance(result, NominalResult)
    assert result.measured is not None
    return result.measured


def check(verdict: Verdict, name: str) -> Any:
    return next(c for c in verdict.checks if c.name == name)


@pytest.mark.parametrize("how", ADVERSARIES)
def test_what_does_not_repeat_is_never_cleared_by_single_calls(how: str) -> None:
    with adversary(how):
        verdict, store = ran(campaign())
    if how == "none":
        assert verdict.verdict == "cleared", verdict.reason
        assert measured(store).text == "repeats bit by bit: 5 points, 15 evaluations"
        assert check(verdict, "noise of calls").ok
        return
    assert verdict.verdict != "cleared", verdict.reason
    assert not check(verdict, "noise of calls").ok
    if verdict.verdict == "inconclusive":
        assert "simulator.repeats to {count: " in verdict.sentence or "does not repeat" in verdict.sentence
