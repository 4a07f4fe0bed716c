"""Confirm: evaluate cases again by the system's independent means, such as half the step and the reference integrator.

A case agrees when all differences are within tolerance and all values are on the same side of the threshold. It is a
confirmed violation when all of them violate, however much they differ. Either way it is validated. Tolerances have
a floor taken from the scale of the threshold, because a fraction of 0 is 0. Start reading at `cases`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from campaigns.results.finding import HalfStep, ReferenceCost, Repeated, Validation
from worker.stages.parts.base import Cancelled, Context
from worker.systems.base import Comparison, Confirmed, Floats

FRACTION_OF_MARGIN = 0.1
FLOOR = 1e-6
"""Fraction of the threshold's scale below which a difference counts as rounding."""


@dataclass(frozen=True)
class Case:
    """A case to simulate again: a name, a point (n,) and, if it drew its own noise, the seed."""

    name: str
    point: Floats
    seed: int | None = None


def cases(context: Context, asked: Sequence[Case]) -> list[Validation]:
    """Every case as the campaign specifies, and by all independent means of the system. Raises `Cancelled`."""
    if not asked:
        return []
    found = context.problem.system.confirm(*_asked(context, asked), context.cancelled)
    if len(found) < len(asked):
        raise Cancelled
    return [_case(context, *case) for case in zip(asked, found, strict=True)]


def reference(context: Context, asked: Sequence[Case]) -> list[Comparison]:
    """Every case, all with a cost, by the strongest independent means. Raises `Cancelled`."""
    if not asked:
        return []
    found = context.problem.system.compare(*_asked(context, asked), context.cancelled)
    if len(found) < len(asked):
        raise Cancelled
    return found


def _asked(context: Context, asked: Sequence[Case]) -> tuple[Floats, list[int | None]]:
    """The vectors of these cases, and the seeds of those that drew their own noise."""
    return context.problem.vectors(np.array([case.point for case in asked])), [case.seed for case in asked]


def scale(context: Context) -> float:
    """The scale of tolerances [the criterion's unit]: the larger of the threshold and the nominal value."""
    return max(abs(context.problem.threshold), abs(context.nominal_cost or 0.0), 1e-9)


def _case(context: Context, case: Case, found: Confirmed) -> Validation:
    threshold, cost = context.problem.threshold, found.cost
    known = [c for c in (cost, *(other.cost for other in found.comparisons)) if c is not None]
    violating = [c <= threshold for c in known]
    allowed = None if cost is None else _allowed(context, cost)
    differences = [None if cost is None or o.cost is None else o.cost - cost for o in found.comparisons]
    close = allowed is not None and all(d is not None and abs(d) <= allowed for d in differences)
    agrees = close and len(set(violating)) == 1
    violates = len(known) == 1 + len(found.comparisons) and all(violating)
    return Validation(
        name=case.name,
        step=found.step,
        cost=cost,
        allowed=allowed,
        agrees=agrees,
        violates=violates,
        ok=agrees or violates,
        realisation=case.seed,
        **{o.kind: _stored(o, by) for o, by in zip(found.comparisons, differences, strict=True)},
    )


def _stored(other: Comparison, difference: float | None) -> Any:
    """A comparison as stored in a validation."""
    if other.kind == "half_step":
        return HalfStep(step=other.step or 0.0, cost=other.cost, difference=difference)
    kind = ReferenceCost if other.kind == "integrator" else Repeated
    return kind(name=other.name, cost=other.cost, difference=difference, reason=other.reason)


def _allowed(context: Context, cost: float) -> float:
    tolerance = context.campaign.stages.validate_.tolerance
    margin = abs(cost - context.problem.threshold)
    floor = min(FLOOR, tolerance) * scale(context)  # the requested tolerance may be below rounding
    return max(min(tolerance * abs(cost), FRACTION_OF_MARGIN * margin), floor)
