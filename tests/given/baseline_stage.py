"""The stage of a baseline and the search for findings after it, of which a function gives the values."""

from __future__ import annotations

from typing import Any

from campaigns import Campaign
from campaigns.stages.baseline import BaselineResult
from campaigns.stages.nominal import NominalResult
from campaigns.stored.records import StagePlan
from clearance.testing.problems import Problem
from clearance.testing.searching import Function, batch
from tests.given.case_campaigns import campaign
from worker.engine.stages import baseline
from worker.engine.stages.parts import findings
from worker.engine.stages.parts.context import Context
from worker.engine.stages.validate import _matching, _reevaluated
from worker.running.runs.store import MemoryStore

PLAN = [StagePlan("nominal", None, 1), StagePlan("baseline", None, 2), StagePlan("validate", None, 10**6)]


def against(*cases: dict[str, Any], **changes: Any) -> Campaign:
    """Case 1 with a baseline of these findings; label and cost are added."""
    listed = [{"label": f"F{i}", "cost": 0.9, **case} for i, case in enumerate(cases, 1)]
    baseline = {"run": "R-0001", "digest": "0" * 64, "threshold": 0.5, "cases": listed}
    return campaign(baseline=baseline, **changes)


def context(made: Campaign, function: Function) -> Context:
    """A run in memory whose evaluations are this function's values."""
    store, problem = MemoryStore(), Problem(made)
    store.plan(PLAN)
    found = Context(made, problem, lambda points, seeds=None: (batch(function(points)), {}), store, plan=PLAN)
    cost = float(function(problem.nominal_point[None, :])[0])
    found.results[0] = NominalResult(cost=cost, margin=cost - problem.threshold, status="ok")
    return found


def ran(made: Context) -> BaselineResult:
    made.results[1] = baseline.run(made, 1).result
    return made.results[1]


def since(made: Context, found: findings.Found, labels: list[str]) -> list[str | None]:
    return [_matching(made, case, [], found, labels) for case in _reevaluated(made)]
