"""Recomputes what pages show beside the claims: curves, slices, minima, Pareto fronts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from campaigns import cube
from campaigns.asked.criteria import named
from campaigns.results.base import OK, STATUS, Values
from campaigns.results.search import FrontCriterion, FrontPoint, Minimum
from campaigns.results.slices import Curve, Slices
from worker.evidence.audit.parts import REST, made
from worker.evidence.audit.recompute import Run

SLICE, FRONT = 41, 2000
"""Points of a slice besides the finding, and of a front."""


def curves(run: Run, k: int) -> list[Curve]:
    """The curves of a sensitivity stage, which are its first evaluations."""
    request = run.campaign.stages.sensitivity
    assert request is not None
    axes = [np.linspace(0.0, 1.0, request.points)] * len(run.bounds)
    rows = np.arange(request.points * len(run.bounds))
    return _curves(run, axes, *(column[rows] for column in run.rows(k)[1:]))


def slices(run: Run, point: Sequence[float], stated: Values) -> Slices:
    """The slices through a finding, from the evaluations of the last stage; NaN where there is none. stated: through
    which point they are in the record."""
    points, raw, status = run.rows(len(run.plan) - 1)
    point = _through(run, point, stated)
    known = {at.tobytes(): row for row, at in enumerate(points)}
    axes = [np.union1d(np.linspace(0.0, 1.0, SLICE), [u]) for u in point]
    at = np.repeat(np.array([point]), sum(map(len, axes)), axis=0)
    for k, (first, last) in enumerate(pairwise(np.cumsum([0, *map(len, axes)]))):
        at[first:last, k] = axes[k]
    rows = np.array([known.get(one.tobytes(), -1) for one in at])
    found = rows >= 0
    costs, ended = np.where(found, raw[rows], np.nan), np.where(found, status[rows], len(STATUS))
    return made(Slices, curves=_curves(run, axes, costs, ended), at=run.values(point))


def _through(run: Run, point: Sequence[float], at: Values) -> Sequence[float]:
    """The evaluated point that slices go through: the finding, or the one beside it that it has replaced, where a
    neighbour was lower by rounding only."""
    if run.values(point) == at:
        return point
    reach = run.campaign.stages.validate_.reach
    near = run.points[(np.abs(run.points - np.array(point)) <= reach).all(axis=1)]
    return next((other.tolist() for other in near if run.values(other) == at), point)


def _curves(run: Run, axes: list[Any], costs: Any, status: Any) -> list[Curve]:
    found = []
    for k, (first, last) in enumerate(pairwise(np.cumsum([0, *map(len, axes)]))):
        path = list(run.bounds)[k]
        (low, high), nominal = run.bounds[path], run.known[path][1]
        values = cube.natural(axes[k][:, None], [nominal], [low], [high])[:, 0].tolist()
        shown = [float(c) if math.isfinite(c) else None for c in costs[first:last]]
        states: dict[int, Any] = dict(enumerate(STATUS))
        ended = [states.get(int(s), "not evaluated") for s in status[first:last]]
        found.append(made(Curve, path=path, values=values, costs=shown, status=ended))
    return found


def minima(run: Run, k: int) -> list[Minimum]:
    """The minima of a search, by the evaluations at their points."""
    points, raw, status = run.rows(k)
    found = []
    for one in run.claims["results"][k]["minima"]:
        here = raw[(status == OK) & (points == np.array(one["point"])).all(axis=1)]
        cost = min(here.tolist(), key=lambda c: abs(c - one["cost"]), default=math.nan)
        at = run.values(one["point"])
        found.append(made(Minimum, cost=cost, parameters=at, **REST))
    return found


def front(run: Run, k: int) -> tuple[list[FrontCriterion], list[FrontPoint] | None, int | None]:
    """The criteria of a search's evaluations, those evaluations that no other one dominates, and their number."""
    criteria = _criteria(run)
    if len(criteria) == 1:
        return criteria, None, None
    here = run.stage == k
    points, costs, ok = run.points[here], run.every[here], np.flatnonzero(run.status[here] == OK)
    order, rows = ok[np.lexsort((np.arange(len(ok)), *costs[ok].T[::-1]))], []
    while len(order):
        rows.append(int(order[0]))
        order = order[(costs[order] < costs[order[0]]).any(axis=1)]
    shown = [rows[i] for i in np.unique(np.linspace(0, len(rows) - 1, min(len(rows), FRONT)).round().astype(np.int64))]
    signs = {c.name: -1.0 if c.worse == "high" else 1.0 for c in criteria}
    values = [dict(zip(signs, (np.array([*signs.values()]) * costs[row]).tolist(), strict=True)) for row in shown]
    of = [
        made(FrontPoint, index=row, parameters=run.values(points[row]), values=each)
        for row, each in zip(shown, values, strict=True)
    ]
    return criteria, of, len(rows)


def _criteria(run: Run) -> list[FrontCriterion]:
    campaign, components = run.campaign, run.claims["components"]
    if campaign.simulator is not None:
        entries = [components.simulator(campaign.simulator.name).result(campaign.criterion.result)]
    else:
        criteria = [campaign.criterion.component, *(objective.component for objective in campaign.objectives)]
        entries = [components.component("criterion", name) for name in criteria]
    names = named(entry.name for entry in entries)
    return [
        made(FrontCriterion, name=name, title=of.title, quantity=of.quantity, unit=of.unit, worse=of.worse)
        for name, of in zip(names, entries, strict=True)
    ]
