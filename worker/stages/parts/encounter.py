"""Encounter: what shows that the avoidance was put to the test at all, as values; what follows is the verdict's.

When the closest approach of nominal and findings took place, how far the vehicle moved, what the nominal flight would
be if the avoider saw no obstacle, and how much each uncertain parameter changes the criterion. Start reading at
`encounter`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.asked.spec import FaultPart
from worker.search.base import OK
from worker.stages.parts.base import Context, all_columns
from worker.stages.parts.store import Trace
from worker.systems.closed_loop.trace import trace
from worker.systems.problem import Problem

UNSEEN = FaultPart(component="blackout", parameters={"at": 0.0, "duration": 1e6})
"""Nothing is ever seen: the avoider steers to the goal as if there were no obstacle."""


def encounter(
    context: Context, position: int, shown: Sequence[Trace], curves: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """The evidence as plain JSON values.

    shown: the traces of the nominal case and of every finding, nominal first; curves: slices through them.
    """
    nominal = shown[0]
    return {
        "closest": [_closest(context, flight) for flight in shown],
        "moved": _moved(nominal),
        "unseen": _unseen(context, nominal),
        "spread": _spread(context, position),
        "influence": _influence(context, curves),
    }


def _closest(context: Context, flight: Trace) -> dict[str, Any]:
    """When the closest approach was, and whether that is the first or the last instant of the flight."""
    closest, rows = flight.meta["closest"], len(flight.data)
    told: dict[str, Any] = {"name": flight.name, "time": None, "at": "none"}
    if closest is None:
        return told
    row = int(closest["row"])
    at = "start" if row == 0 else "end" if row >= rows - 1 else "inside"
    return told | {"time": float(closest["time"]), "at": at, "obstacle": int(closest["obstacle"])}


def _moved(flight: Trace) -> float | None:
    """The length of the path [m]; None for a flight without rows."""
    path = flight.data[:, 1:4]
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) if len(path) else None


def _unseen(context: Context, nominal: Trace) -> dict[str, Any]:
    """The nominal case with an avoider that sees nothing, one simulation in plain Python: its cost, and the largest
    distance between the two paths at one instant [m]."""
    blind = Problem(unseen(context.campaign), compiled=False, lanes=1)
    # Of several realisations the one that the nominal trace shows: the worst, whose cost is the evaluation's.
    flight = trace(blind.under(nominal.meta.get("realisation", {}).get("seed")), "unseen", {})
    rows = min(len(flight.data), len(nominal.data))
    apart = np.linalg.norm(flight.data[:rows, 1:4] - nominal.data[:rows, 1:4], axis=1)
    return {
        "cost": flight.meta["cost"],
        "status": flight.meta["status"],
        "reason": flight.meta["reason"],
        "deviation": float(apart.max()) if rows else None,
    }


def unseen(campaign: Campaign) -> Campaign:
    """The campaign with nothing to be seen."""
    scenario = campaign.scenario
    return campaign.model_copy(update={"scenario": scenario.model_copy(update={"faults": [*scenario.faults, UNSEEN]})})


def _spread(context: Context, position: int) -> dict[str, Any]:
    """Lowest and highest cost of all stored evaluations."""
    costs = [c.costs[c.status == OK, 0] for _, c in all_columns(context, [*range(position + 1)])]
    known = np.concatenate([*costs, np.empty(0)])
    if not len(known):
        return {"evaluations": 0, "lowest": None, "highest": None}
    return {"evaluations": len(known), "lowest": float(known.min()), "highest": float(known.max())}


def _influence(context: Context, curves: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """By path: the largest difference that a parameter alone makes along any of the slices."""
    found = {r.path: 0.0 for r in context.problem.ranges}
    for curve in curves:
        known = [c for c in curve["costs"] if c is not None]
        if known:
            found[curve["path"]] = max(found[curve["path"]], max(known) - min(known))
    return found
