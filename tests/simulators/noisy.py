"""Campaigns on the adversaries, and their audited runs."""

from __future__ import annotations

from typing import Any

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results import Verdict
from campaigns.sample_seed import SampleSeed
from tests.audited import audited
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

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
                "validate": {"neighbours": 20, "evaluations": 20_000},
            },
        }
    )


def by_auto(**simulator: Any) -> Campaign:
    """`auto` alone, of which it is stated how sure it is."""
    asked = campaign(certify=60, **simulator).document()
    asked["stages"]["search"] = [{"method": "auto", "evaluations": 300}]
    return load_document(asked)


def ran(asked: Campaign) -> tuple[Verdict, MemoryStore]:
    store = MemoryStore(sample_seed=SampleSeed(1, stated=False))
    verdict = execute(asked, store, threads=1)
    audited(store, asked)
    return verdict, store
