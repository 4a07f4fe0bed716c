"""Independent calls of a simulator that does not repeat, each in a fresh process.

A case violates if at least one of its independent calls does; the evaluation that made a search choose the case does
not count, because the search has selected it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from campaigns.claims.stages import calls as sentences
from campaigns.results.base import OK
from campaigns.results.finding import Calls, Validation
from worker.engine.search.parts.proportion import interval
from worker.engine.stages.parts.context import Cancelled, Context
from worker.engine.systems.base import Floats, slotted


@dataclass(frozen=True)
class Case:
    """A case to simulate again: a name, a point (n,), the stored cost, if any, and, if it drew its own noise, the
    seed."""

    name: str
    point: Floats
    cost: float | None
    seed: int | None = None


def cases(context: Context, subjects: Sequence[Case], calls: int | None = None) -> list[Validation]:
    """Every case by this many independent calls, or as many as the campaign states. Raises `Cancelled`."""
    many = context.campaign.stages.validate_.repeats if calls is None else calls
    return [_case(context, case, *_called(context, case.point, many)) for case in subjects]


def of_values(values: Sequence[float | None], reasons: Sequence[str], threshold: float, confidence: float) -> Calls:
    """What the independent calls of a case show."""
    violating = sum(v is not None and v <= threshold for v in values)
    failed = sum(v is None for v in values)
    low, high = interval(violating, len(values), confidence, failed)
    return Calls(
        values=list(values),
        reasons=list(dict.fromkeys(reasons))[:5],
        violating=violating,
        failed=failed,
        confidence=confidence,
        low=low,
        high=high,
        statement=sentences.independent(violating, failed, len(values), low, high),
    )


def _called(context: Context, point: Floats, many: int) -> tuple[list[float | None], list[str]]:
    """The values of these calls, and the reasons of those that failed."""
    vector, system = context.problem.vectors(point[None, :]), slotted(context.problem.system).single()
    values: list[float | None] = []
    reasons: list[str] = []
    while len(values) < many:
        if context.cancelled():
            raise Cancelled
        fresh = slotted(system.fresh())
        # Each evaluation in a fresh slot has a process of its own; without slots each needs a fresh system.
        count = min(4 * fresh.slots or 1, many - len(values))
        try:
            batch, why = fresh.evaluate(np.repeat(vector, count, axis=0))
        finally:
            if fresh is not system:
                fresh.close()
        for row in range(count):
            ok = batch.status[row] == OK and np.isfinite(batch.costs[row, 0])
            values.append(float(batch.costs[row, 0]) if ok else None)
            reasons += [] if ok else [why.get(row, sentences.CALL_FAILED)]
    return values, reasons


def _case(context: Context, case: Case, values: list[float | None], reasons: list[str]) -> Validation:
    threshold = context.problem.threshold
    repeats = of_values(values, reasons, threshold, context.campaign.confidence)
    violates = repeats.violating > 0
    agrees = case.cost is not None and case.cost > threshold and not violates and not repeats.failed
    return Validation(
        name=case.name,
        step=None,
        cost=case.cost,
        allowed=None,
        agrees=agrees,
        violates=violates,
        ok=agrees or violates,
        repeats=repeats,
    )
