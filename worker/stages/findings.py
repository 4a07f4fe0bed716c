"""Findings: all distinct worst cases, from the local minima of every method and the low end of all evaluations.

Gathers candidates stage by stage, descends from them, merges what ends in one basin, polishes, flies neighbours (the
objective is not smooth). The tests of what is distinct are in `worker.search.basins`. Start reading at `search`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from worker.problem import Floats
from worker.search.base import OK, Search, Space
from worker.search.basins import Basin, Rules, distinct, promising
from worker.stages.base import Context, all_columns
from worker.stages.boundary import after
from worker.store import Columns

EACH, ALL = 12, 60
"""Points to descend from: of every stage's evaluations at most, and of everything at most."""
SAME_COST, SAME_PLACE = 0.01, 0.05
"""A method found a worst case when it came this close by itself: share of nominal minus worst, share of every range."""
FINDINGS_STREAM = 2**20
"""Spawn key of this stage's random numbers; searches are numbered from 0."""


@dataclass(frozen=True)
class Candidate:
    """A point (n,) to descend from, its cost, and the stage that evaluated it."""

    point: Floats
    cost: float
    position: int


@dataclass
class Found:
    """What is known so far: candidates and basins; of each basin what its neighbours gave, slices, the boundary."""

    candidates: list[Candidate] = field(default_factory=list)
    basins: list[Basin] = field(default_factory=list)
    left_out: int = 0
    neighbours: list[dict[str, Any]] = field(default_factory=list)
    after: list[dict[str, Any]] = field(default_factory=list)


def search(context: Context, position: int, found: Found) -> Search:
    """Ask for whatever tells the worst cases apart; `found` is up to date at every moment."""
    found.candidates = gather(context, position)
    if not found.candidates:
        return "no flight was evaluated"
    points = np.array([c.point for c in found.candidates])
    costs = np.array([c.cost for c in found.candidates])
    rules = _rules(context, float(costs.min()))
    yield from distinct(points, costs, rules, _space(context), found.basins)
    _keep_the_worst(context, found)
    yield from _neighbours(context, found)
    for basin in found.basins:
        found.after.append((yield from after(context.problem, basin.point, basin.cost)))
    return "polished every distinct worst case and flew its neighbours"


def gather(context: Context, position: int) -> list[Candidate]:
    """The candidates of all stages before this one, the lowest first."""
    found = []
    for at, columns in all_columns(context, list(range(position))):
        ranked = _ranked(columns)
        rows = [int(i) for i in promising(columns.points, ranked, EACH)]
        found += [Candidate(columns.points[i].copy(), float(ranked[i]), at) for i in rows]
        for minimum in context.results.get(at, {}).get("minima", []):
            found.append(Candidate(np.array(minimum["point"]), float(minimum["cost"]), at))
    return sorted(found, key=lambda c: c.cost)[:ALL]


def reached(context: Context, columns: Columns, basin: Basin) -> int | None:
    """How many evaluations a stage needed until it first came close to this worst case; None where it never did."""
    near = SAME_COST * scale(context, basin.cost)
    low = (columns.status == OK) & (columns.costs[:, 0] <= basin.cost + near)
    close = low & (np.abs(columns.points - basin.point) <= SAME_PLACE).all(axis=1)
    return int(np.argmax(close)) + 1 if close.any() else None


def scale(context: Context, worst: float) -> float:
    """Nominal minus worst [the criterion's unit]; the size of the worst where the nominal flight has no cost above."""
    nominal = context.results[0].get("cost")
    fall = 0.0 if nominal is None else float(nominal) - worst
    return fall if fall > 0.0 else max(abs(worst), 1e-12)


def _ranked(columns: Columns) -> Floats:
    return np.where(columns.status == OK, columns.costs[:, 0], np.inf)


def _rules(context: Context, lowest: float) -> Rules:
    asked = context.campaign.stages.findings
    return Rules(asked.distance, asked.barrier * scale(context, lowest), asked.at_most)


def _space(context: Context) -> Space:
    n = context.problem.dimension
    random = np.random.default_rng(np.random.SeedSequence(context.campaign.seed, spawn_key=(FINDINGS_STREAM,)))
    return Space(n, 0, random, np.empty((0, n)), context.problem.quantile, lambda minimum: None)


def _keep_the_worst(context: Context, found: Found) -> None:
    """A minimum no worse than the nominal flight is no worst case, unless it violates or is the lowest."""
    nominal = context.results[0].get("cost")
    limit = max(np.inf if nominal is None else float(nominal), context.problem.threshold)
    kept = [b for i, b in enumerate(found.basins) if i == 0 or b.cost < limit]
    found.left_out += len(found.basins) - len(kept)
    found.basins[:] = kept


def _neighbours(context: Context, found: Found) -> Search:
    """A few hundred neighbours of every worst case; the lowest of them takes its place."""
    asked = context.campaign.stages.validate_
    if asked.neighbours == 0:
        return "no neighbours were asked for"
    random = _space(context).random
    for basin in list(found.basins):
        offsets = random.uniform(-asked.reach, asked.reach, (asked.neighbours, len(basin.point)))
        points = np.clip(basin.point + offsets, 0.0, 1.0)
        batch = yield points
        ranked = batch.ranked()
        low = int(np.argmin(ranked))
        found.neighbours.append({
            "flown": len(points),
            "failed": int(np.count_nonzero(batch.status != OK)),
            "lowest": float(ranked[low]) if np.isfinite(ranked[low]) else None,
            "lower_by": max(0.0, basin.cost - float(ranked[low])),
        })  # fmt: skip
        if ranked[low] < basin.cost:
            basin.point, basin.cost = points[low].copy(), float(ranked[low])
    return "flew every neighbour"
