"""Encounter: evidence that the avoidance was tested at all, as values; the verdict draws the conclusions.

The evidence: when the closest approach of the nominal case and the findings took place, what they and the sample meet
beyond the horizon, how far the vehicle moved, the nominal case with an avoider that sees no obstacle (if the system
supports these), and the effect of each uncertain parameter on the criterion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from campaigns.limits import ROUNDING
from campaigns.results.base import OK, Status
from campaigns.results.finding import ClosestApproach, Finding
from campaigns.results.slices import Curve
from campaigns.results.validate import Beyond, Encounter, Spread
from campaigns.stored.records import Trace
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.stages.parts.seeds import drawn
from worker.engine.systems import optional


def encounter(
    context: Context, position: int, nominal: Trace | None, findings: Sequence[Finding], curves: Iterable[Curve]
) -> Encounter:
    """The evidence of the run. curves: all slices, through the nominal point and the findings."""
    shown = optional.encounter(context.problem.system, nominal)
    spread, curves = _spread(context, position), [*curves]
    return Encounter(
        closest=ClosestApproach() if shown is None else shown.closest,
        moved=None if shown is None else shown.moved,
        unseen=None if shown is None else shown.unseen,
        spread=spread,
        influence=influence(curves),
        no_value=no_value(curves),
        beyond=None if spread.lowest is None else _beyond(context, findings, spread.lowest),
    )


def _beyond(context: Context, findings: Sequence[Finding], lowest: float) -> Beyond | None:
    """What the nominal case, the findings and every evaluation of the sample meet after the horizon."""
    problem = context.problem
    certified = [at for at, result in context.results.items() if result.certificate is not None]
    own = {at: seeds for at, _, seeds in drawn(context, certified)}
    names = ["nominal", *(f.label for f in findings)]
    points = [problem.nominal_point, *(np.array(f.point) for f in findings)]
    realised = [None, *(f.realisation for f in findings)]
    for at, columns in all_columns(context, certified):
        succeeded = np.flatnonzero(columns.status == OK)
        names += [f"evaluation {i} of the sample" for i in succeeded]
        points += [*columns.points[succeeded]]
        realised += [int(own[at][i]) if i < len(own.get(at, ())) else None for i in succeeded]
    below = lowest - ROUNDING * max(abs(lowest), abs(problem.threshold))
    vectors = problem.vectors(np.array(points))
    found = optional.beyond(problem.system, names, vectors, realised, below, context.cancelled)
    if context.cancelled():
        raise Cancelled
    return found


def _spread(context: Context, position: int) -> Spread:
    """Lowest and highest cost of all stored evaluations."""
    every = [
        (c.costs[c.status == OK, 0], c.points[c.status == OK]) for _, c in all_columns(context, [*range(position + 1)])
    ]
    known = np.concatenate([*(costs for costs, _ in every), np.empty(0)])
    if not len(known):
        return Spread(evaluations=0, lowest=None, highest=None)
    first = next(points[0] for _, points in every if len(points))
    one = all(bool((points == first).all()) for _, points in every)
    return Spread(evaluations=len(known), lowest=float(known.min()), highest=float(known.max()), one_point=one)


def influence(curves: Iterable[Curve]) -> dict[str, float]:
    """The largest difference that a parameter alone makes along any slice, by path; only of those that have
    several values."""
    found: dict[str, float] = {}
    for curve in curves:
        known = [c for c in curve.costs if c is not None]
        if len(known) > 1:
            found[curve.path] = max(found.get(curve.path, 0.0), max(known) - min(known))
    return found


def no_value(curves: Iterable[Curve]) -> dict[str, list[Status]]:
    """How the evaluations without a value ended along the slices of a parameter, by path; only of those that have
    such."""
    found: dict[str, set[Status]] = {}
    for curve in curves:
        ended = {status for status, cost in zip(curve.status, curve.costs, strict=True) if cost is None}
        if ended:
            found[curve.path] = found.get(curve.path, set()) | ended
    return {path: sorted(ended) for path, ended in found.items()}
