"""Encounter: evidence that the avoidance was tested at all, as values; the verdict draws the conclusions.

The evidence: when the closest approach of the nominal case and the findings took place, what they, the sample and
other evaluations meet beyond the horizon, how far the vehicle moved, the nominal case with an avoider that sees no
obstacle (if the system supports these), and the effect of each uncertain parameter on the criterion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from campaigns.limits import OTHERS, ROUNDING
from campaigns.results.base import OK, Status
from campaigns.results.finding import ClosestApproach, Finding
from campaigns.results.slices import Curve
from campaigns.results.validate import Beyond, Encounter, Spread
from campaigns.stages.found import declared
from campaigns.stored.records import Trace
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.stages.parts.grid import grid
from worker.engine.stages.parts.seeds import drawn
from worker.engine.systems import optional
from worker.engine.systems.base import Floats

MOST = 100_000
"""Of more points only every second, third and so on is looked at."""


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
        begins={} if shown is None else dict(shown.begins),
        idle={} if shown is None else dict(shown.idle),
        whole={} if shown is None else dict(shown.whole),
        mismeasured=None if shown is None else shown.mismeasured,
        spread=spread,
        influence=influence(curves),
        no_value=no_value(curves),
        beyond=None if spread.lowest is None else _beyond(context, position, findings, spread.lowest),
    )


def _beyond(context: Context, position: int, findings: Sequence[Finding], lowest: float) -> Beyond | None:
    """What the nominal case, the findings, every evaluation of the sample and others meet after the horizon."""
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
    others, left_out = _others(context, position, certified)
    names += [name for name, _ in others]
    points += [point for _, point in others]
    realised += [None] * len(others)
    below = lowest - ROUNDING * max(abs(lowest), abs(problem.threshold))
    vectors = problem.vectors(np.array(points))
    found = optional.beyond(problem.system, names, vectors, realised, below, context.cancelled)
    if context.cancelled():
        raise Cancelled
    return (
        None if found is None else found.model_copy(update={"not_continued": left_out + _uncounted(context, certified)})
    )


def _others(context: Context, position: int, certified: Sequence[int]) -> tuple[list[tuple[str, Floats]], int]:
    """Evaluations besides the sample, with their names, and how many are left out. A search looks for what is lowest
    within the horizon, and the sample where its distribution is; so those are chosen that are far from each other."""
    elsewhere = [at for at in range(position + 1) if at not in certified]
    points, where = [np.empty((0, context.problem.dimension))], [np.empty((0, 2), dtype=np.int64)]
    for at, columns in all_columns(context, elsewhere):
        succeeded = np.flatnonzero(columns.status == OK)
        points.append(columns.points[succeeded])
        where.append(np.stack([np.full_like(succeeded, at), succeeded], axis=1))
    every, stored = np.concatenate(points), np.concatenate(where)
    chosen = apart(every, OTHERS)
    return [(_named(context, *map(int, stored[k])), every[k]) for k in chosen], len(every) - len(chosen)


def _named(context: Context, position: int, index: int) -> str:
    """The words for an evaluation."""
    result = context.results.get(position)
    title = getattr(result, "title", "") or declared()[context.plan[position].kind].title.lower()
    return f"evaluation {index} of {title}"


def _uncounted(context: Context, certified: Sequence[int]) -> int:
    """The evaluations of the sample with a value that are only counted, and not stored."""
    beside = (context.results[at].beside for at in certified)
    return sum(each.evaluations - each.failed - each.excluded for each in beside)


def apart(points: Floats, count: int) -> list[int]:
    """The indices of at most so many of the points (n, d), in order. Each is as far as possible from those that are
    chosen before it, so that the ends of the bounds come first."""
    if len(points) <= count:
        return [*range(len(points))]
    every = -(-len(points) // MOST)
    some, chosen = points[::every], [0]
    nearest = np.full(len(some), np.inf)
    while len(chosen) < count:
        nearest = np.minimum(nearest, ((some - some[chosen[-1]]) ** 2).sum(axis=1))
        nearest[chosen] = -1.0
        chosen.append(int(nearest.argmax()))
    return [every * k for k in sorted(chosen)]


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
    lowest, highest = float(known.min()), float(known.max())
    return Spread(evaluations=len(known), lowest=lowest, highest=highest, one_point=one, grid=grid(known))


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
