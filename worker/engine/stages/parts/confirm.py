"""Confirm: evaluate cases again by the system's independent means, such as half the step and the reference integrator.

A case agrees when all differences are within tolerance and all values are on the same side of the threshold. It is a
confirmed violation when all of them violate, however much they differ. Either way it is validated. Tolerances have
a floor taken from the scale of the threshold, because a fraction of 0 is 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from campaigns.claims.stages import calls as sentences
from campaigns.limits import ROUNDING, TOLERANCE_OF_MARGIN
from campaigns.results.finding import HalfStep, ReferenceCost, Repeated, Validation
from worker.engine.stages.parts import noise, repeated
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.stages.parts.repeated import Case
from worker.engine.systems import optional
from worker.engine.systems.base import Comparison, Confirmed, Floats


def cases(context: Context, subjects: Sequence[Case], calls: int | None = None) -> list[Validation]:
    """Every case as the campaign specifies, and by all independent means of the system. Raises `Cancelled`.

    Of a simulator that does not repeat: by independent calls, as many as the campaign states unless given.
    """
    if not subjects:
        return []
    if noise.noisy(context):
        return repeated.cases(context, subjects, calls)
    found = context.problem.system.confirm(*_vectors_and_seeds(context, subjects), context.cancelled)
    if len(found) < len(subjects):
        raise Cancelled
    return [_case(context, *case) for case in zip(subjects, found, strict=True)]


def reference(context: Context, subjects: Sequence[Case]) -> list[Comparison]:
    """Every case, all with a cost, by the strongest independent means. Raises `Cancelled`."""
    if not subjects:
        return []
    found = optional.compare(context.problem.system, *_vectors_and_seeds(context, subjects), context.cancelled)
    if len(found) < len(subjects):
        raise Cancelled
    return found


def _vectors_and_seeds(context: Context, subjects: Sequence[Case]) -> tuple[Floats, list[int | None]]:
    return context.problem.vectors(np.array([case.point for case in subjects])), [case.seed for case in subjects]


def _case(context: Context, case: Case, found: Confirmed) -> Validation:
    threshold = context.problem.threshold
    found = found if context.campaign.simulator is None else _against(case.cost, found, threshold)
    cost = found.cost
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


def _against(stored: float | None, found: Confirmed, threshold: float) -> Confirmed:
    """A simulator's evaluations against the stored one, which they must equal; of those made again, the one that speaks
    most against it is retained: one that failed, one on the other side of the threshold, the most different one."""

    def contrary(other: Comparison) -> tuple[bool, bool, float]:
        if other.cost is None or stored is None:
            return (other.cost is None) != (stored is None), True, 0.0
        return False, (other.cost <= threshold) != (stored <= threshold), abs(other.cost - stored)

    again = [c for c in found.comparisons if c.kind == "again"]
    rest = tuple(c for c in found.comparisons if c.kind != "again")
    used = Comparison("again", sentences.USED_PROCESS, found.cost, "" if found.cost is not None else sentences.FAILED)
    # With equal evidence the fresh one, which is the stronger.
    return Confirmed(stored, (max([*again, used], key=contrary), *rest), found.step)


def _stored(other: Comparison, difference: float | None) -> Any:
    if other.kind == "half_step":
        return HalfStep(step=other.step or 0.0, cost=other.cost, difference=difference, reason=other.reason)
    kind = ReferenceCost if other.kind == "integrator" else Repeated
    return kind(name=other.name, cost=other.cost, difference=difference, reason=other.reason)


def _allowed(context: Context, cost: float) -> float:
    tolerance = context.campaign.stages.validate_.tolerance
    margin = abs(cost - context.problem.threshold)
    # The requested tolerance may be below rounding. The nominal cost is no scale: it may stand for "no encounter".
    floor = min(ROUNDING, tolerance) * max(abs(context.problem.threshold), abs(cost), 1e-9)
    return max(min(tolerance * abs(cost), TOLERANCE_OF_MARGIN * margin), floor)
