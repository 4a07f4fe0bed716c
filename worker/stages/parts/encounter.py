"""Encounter: what shows that the avoidance was put to the test at all, as values; what follows is the verdict's.

When the closest approach of nominal and findings took place, how far the vehicle moved, what the nominal flight would
be if the avoider saw no obstacle, and how much each uncertain parameter changes the criterion. Start reading at
`encounter`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import numpy as np

from campaigns import Campaign
from campaigns.asked.spec import FaultPart
from campaigns.results.base import OK
from campaigns.results.finding import ClosestApproach
from campaigns.results.sensitivity import Curve
from campaigns.results.validate import Encounter, Spread, Unseen
from worker.stages.parts.base import Context, all_columns
from worker.stages.parts.store import Trace
from worker.systems.closed_loop.trace import trace
from worker.systems.problem import Problem

UNSEEN = FaultPart(component="blackout", parameters={"at": 0.0, "duration": 1e6})
"""Nothing is ever seen: the avoider steers to the goal as if there were no obstacle."""


def encounter(context: Context, position: int, nominal: Trace, curves: Iterable[Curve]) -> Encounter:
    """The evidence of the run. curves: all slices, through the nominal point and the findings."""
    return Encounter(
        closest=closest(nominal),
        moved=_moved(nominal),
        unseen=_unseen(context, nominal),
        spread=_spread(context, position),
        influence=_influence(context, curves),
    )


def closest(flight: Trace) -> ClosestApproach:
    """When the closest approach was, and whether that is the first or the last instant of the flight."""
    found = flight.meta.closest
    if found is None:
        return ClosestApproach()
    last = len(flight.data) - 1
    at: Literal["start", "end", "inside"] = "start" if found.row == 0 else "end" if found.row >= last else "inside"
    return ClosestApproach(time=found.time, at=at, obstacle=found.obstacle)


def _moved(flight: Trace) -> float | None:
    """The length of the path [m]; None for a flight without rows."""
    path = flight.data[:, 1:4]
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) if len(path) else None


def _unseen(context: Context, nominal: Trace) -> Unseen:
    """The nominal case with an avoider that sees nothing, one simulation in plain Python: its cost, and the largest
    distance between the two paths at one instant [m]."""
    shown = nominal.meta.realisation
    blind = Problem(unseen(context.campaign), compiled=False, lanes=1)
    # Of several realisations the one that the nominal trace shows: the worst, whose cost is the evaluation's.
    flight = trace(blind.under(None if shown is None else shown.seed), "unseen", {})
    rows = min(len(flight.data), len(nominal.data))
    apart = np.linalg.norm(flight.data[:rows, 1:4] - nominal.data[:rows, 1:4], axis=1)
    return Unseen(
        cost=flight.meta.cost,
        status=flight.meta.status,
        reason=flight.meta.reason,
        deviation=float(apart.max()) if rows else None,
    )


def unseen(campaign: Campaign) -> Campaign:
    """The campaign with nothing to be seen."""
    scenario = campaign.scenario
    return campaign.model_copy(update={"scenario": scenario.model_copy(update={"faults": [*scenario.faults, UNSEEN]})})


def _spread(context: Context, position: int) -> Spread:
    """Lowest and highest cost of all stored evaluations."""
    costs = [c.costs[c.status == OK, 0] for _, c in all_columns(context, [*range(position + 1)])]
    known = np.concatenate([*costs, np.empty(0)])
    if not len(known):
        return Spread(evaluations=0, lowest=None, highest=None)
    return Spread(evaluations=len(known), lowest=float(known.min()), highest=float(known.max()))


def _influence(context: Context, curves: Iterable[Curve]) -> dict[str, float]:
    """By path: the largest difference that a parameter alone makes along any of the slices."""
    found = {r.path: 0.0 for r in context.problem.ranges}
    for curve in curves:
        known = [c for c in curve.costs if c is not None]
        if known:
            found[curve.path] = max(found[curve.path], max(known) - min(known))
    return found
