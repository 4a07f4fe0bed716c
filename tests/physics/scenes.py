"""Small changes to library campaigns, and simulations without a compiler, for the physics tests."""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from worker.engine.systems.base import Floats

AT_NIGHT = frozenset(f"uav_{case}_{kind}" for case in ("static", "moving", "aca") for kind in ("linear", "bank"))
"""Variants of cases 3 to 5 that are compiled at night. By day one with each model and autopilot is simulated in plain
Python, and tests/contract/test_compiled.py compiles their components."""


def nightly(names: Iterable[str], night: Collection[str] = AT_NIGHT) -> list[Any]:
    """Campaigns of the library as parameters of a test, some of them at night."""
    return [pytest.param(name, marks=pytest.mark.nightly) if name in night else name for name in names]


def changed(campaign: Campaign, **scenario: Any) -> Campaign:
    """The campaign with parts of its scenario replaced and next to nothing uncertain."""
    document = copy.deepcopy(campaign.document())
    document["scenario"] |= scenario
    document["uncertain"] = {"start.x": {"plus_minus": 1e-3}}
    document["stages"]["search"] = [{"method": "direct", "evaluations": 1}]
    return load_document(document)


def uncompiled(campaign: Campaign) -> Problem:
    """The campaign in plain Python, one flight at a time."""
    return Problem(campaign, compiled=False)


def cost(problem: Problem, values: dict[str, float] | None = None, step: float | None = None) -> float:
    """The criterion's value of one flight, which must be ok."""
    batch, reasons = problem.system.simulate_vectors(problem.vector(values or {})[None], step)
    assert batch.status[0] == OK, reasons
    return float(batch.costs[0, 0])


def flight(problem: Problem, values: dict[str, float] | None = None, step: float | None = None) -> Floats:
    """The states of one flight (steps + 1, states)."""
    step = step or problem.system.step
    vector = problem.vector(values or {})
    return problem.system.loop.simulate(vector[None], step, *problem.system.counts(step), traced=1).trace[0]
