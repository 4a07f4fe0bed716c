"""Confirm: simulate cases again by other means, at half the step and with the reference integrator.

A case agrees when both differences are within tolerance and all three values lie on the same side of the threshold. It
is a confirmed violation when all three violate, however far they are apart. Either way it is validated. Tolerances have
a floor taken from the scale of the threshold, because a fraction of 0 is 0. Start reading at `cases`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from campaigns.results.base import OK
from campaigns.results.finding import HalfStep, ReferenceCost, Validation
from worker.reference import NAME, Flight, Reference
from worker.stages.parts.base import Cancelled, Context
from worker.systems.problem import Floats

FRACTION_OF_MARGIN = 0.1
FLOOR = 1e-6
"""Fraction of the threshold's scale below which a difference counts as rounding."""


@dataclass(frozen=True)
class Case:
    """What is simulated again: a name, a point (n,) and, where it drew its own noise, the seed."""

    name: str
    point: Floats
    seed: int | None = None


def cases(context: Context, asked: Sequence[Case]) -> list[Validation]:
    """Every case at the campaign's step, at half of it and with the reference integrator.

    Raises `Cancelled`.
    """
    step = context.problem.step
    (full, counts), (half, _) = (costs(context, asked, s) for s in (step, step / 2))
    others = reference(context, asked, [cost is not None for cost in full], counts)
    return [_case(context, *case) for case in zip(asked, full, half, others, strict=True)]


def costs(context: Context, asked: Sequence[Case], step: float) -> tuple[list[float | None], list[int | None]]:
    """The cost of every case at this step [s], None where it has none; and the seed that counts, None for a mean."""
    problem = context.problem
    found: list[float | None] = [None] * len(asked)
    counts = [case.seed for case in asked]
    for own in (False, True):
        rows = [i for i, case in enumerate(asked) if (case.seed is not None) == own]
        if rows:
            vectors = problem.vectors(np.array([asked[i].point for i in rows]))
            if own:
                batch, _ = problem.fly_vectors(vectors, step, np.array([asked[i].seed for i in rows], dtype=np.int64))
            else:
                batch, _, worst = problem.fly_realised(vectors, step)
                for i, seed in zip(rows, worst or (), strict=worst is not None):
                    counts[i] = seed
            for i, cost, status in zip(rows, batch.costs[:, 0], batch.status, strict=True):
                found[i] = float(cost) if status == OK else None
    return found, counts


def reference(
    context: Context, asked: Sequence[Case], known: Sequence[bool], counts: Sequence[int | None] | None = None
) -> list[Flight]:
    """Every case with the reference integrator; one that has no cost at the campaign's step is left out: it may be
    beyond any explicit integrator. counts: the seeds that count, as in `Reference.fly`. Raises `Cancelled`."""
    counts = [None] * len(asked) if counts is None else counts
    found = [Flight(None, "the evaluation failed")] * len(asked)
    by_seed: dict[int | None, list[int]] = {}
    for i, (case, has_cost) in enumerate(zip(asked, known, strict=True)):
        if has_cost:
            by_seed.setdefault(case.seed, []).append(i)
    for seed, rows in by_seed.items():
        problem = context.problem.under(seed)
        vectors = problem.vectors(np.array([asked[i].point for i in rows]))
        flights = Reference(problem).fly_all(vectors, context.cancelled, [counts[i] for i in rows])
        if len(flights) < len(rows):
            raise Cancelled
        for i, flight in zip(rows, flights, strict=True):
            found[i] = flight
    return found


def scale(context: Context) -> float:
    """The size of what is compared [the criterion's unit]: the threshold or the nominal value, whichever is larger."""
    return max(abs(context.problem.threshold), abs(context.nominal_cost or 0.0), 1e-9)


def _case(context: Context, case: Case, cost: float | None, half: float | None, other: Flight) -> Validation:
    threshold, step = context.problem.threshold, context.problem.step
    known = [c for c in (cost, half, other.cost) if c is not None]
    violating = [c <= threshold for c in known]
    allowed = None if cost is None else _allowed(context, cost)
    differences = [None if cost is None or c is None else c - cost for c in (half, other.cost)]
    close = allowed is not None and all(d is not None and abs(d) <= allowed for d in differences)
    agrees, violates = close and len(set(violating)) == 1, len(known) == 3 and all(violating)
    return Validation(
        name=case.name,
        step=step,
        cost=cost,
        half_step=HalfStep(step=step / 2, cost=half, difference=differences[0]),
        integrator=ReferenceCost(name=NAME, cost=other.cost, difference=differences[1], reason=other.reason),
        allowed=allowed,
        agrees=agrees,
        violates=violates,
        ok=agrees or violates,
        realisation=case.seed,
    )


def _allowed(context: Context, cost: float) -> float:
    tolerance = context.campaign.stages.validate_.tolerance
    margin = abs(cost - context.problem.threshold)
    floor = min(FLOOR, tolerance) * scale(context)  # an author may ask for less than rounding
    return max(min(tolerance * abs(cost), FRACTION_OF_MARGIN * margin), floor)
