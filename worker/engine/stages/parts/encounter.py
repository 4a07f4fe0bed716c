"""Encounter: evidence that the avoidance was tested at all, as values; the verdict draws the conclusions.

The evidence: when the closest approach of the nominal case and the findings took place, how far the vehicle moved, the
nominal case with an avoider that sees no obstacle (if the system supports these), and the effect of each uncertain
parameter on the criterion.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from campaigns.results.base import OK
from campaigns.results.finding import ClosestApproach
from campaigns.results.slices import Curve
from campaigns.results.validate import Encounter, Spread
from worker.engine.stages.parts.base import Context, all_columns
from worker.engine.stages.parts.store import Trace


def encounter(context: Context, position: int, nominal: Trace | None, curves: Iterable[Curve]) -> Encounter:
    """The evidence of the run. curves: all slices, through the nominal point and the findings."""
    shown = context.problem.system.encounter(nominal)
    return Encounter(
        closest=ClosestApproach() if shown is None else shown.closest,
        moved=None if shown is None else shown.moved,
        unseen=None if shown is None else shown.unseen,
        spread=_spread(context, position),
        influence=influence(curves),
    )


def _spread(context: Context, position: int) -> Spread:
    """Lowest and highest cost of all stored evaluations."""
    costs = [c.costs[c.status == OK, 0] for _, c in all_columns(context, [*range(position + 1)])]
    known = np.concatenate([*costs, np.empty(0)])
    if not len(known):
        return Spread(evaluations=0, lowest=None, highest=None)
    return Spread(evaluations=len(known), lowest=float(known.min()), highest=float(known.max()))


def influence(curves: Iterable[Curve]) -> dict[str, float]:
    """The largest difference that a parameter alone makes along any slice, by path; only of those that have
    several values."""
    found: dict[str, float] = {}
    for curve in curves:
        known = [c for c in curve.costs if c is not None]
        if len(known) > 1:
            found[curve.path] = max(found.get(curve.path, 0.0), max(known) - min(known))
    return found
