"""Small changes to library campaigns, and simulations without a compiler, for the physics tests."""

from __future__ import annotations

import copy
from typing import Any

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from tests.problems import Problem
from worker.systems.base import Floats
from worker.systems.closed_loop.assemble import Loop


def changed(campaign: Campaign, **scenario: Any) -> Campaign:
    """The campaign with parts of its scenario replaced and next to nothing uncertain."""
    document = copy.deepcopy(campaign.document())
    document["scenario"] |= scenario
    document["uncertain"] = {"start.x": {"plus_minus": 1e-3}}
    document["stages"]["search"] = [{"method": "direct", "evaluations": 1}]
    return load_document(document)


def uncompiled(campaign: Campaign) -> Problem:
    """The campaign in plain Python, one flight at a time."""
    problem = Problem(campaign, compiled=False)
    problem.system.loop = Loop(problem.system.parts, lanes=1, compiled=False)
    return problem


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
