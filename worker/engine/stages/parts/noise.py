"""Whether the evaluations of a simulator repeat: measured before anything is searched."""

from __future__ import annotations

from collections import Counter

import numpy as np

from campaigns.claims.stages import calls as sentences
from campaigns.claims.stages import ends
from campaigns.results.base import EXCLUDED, FLAKY, OK
from campaigns.results.measured import Measured
from campaigns.stages.nominal import POINTS, TIMES
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.base import stream
from worker.engine.stages.parts.context import Asking, Context, Through
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, slotted

STREAM = 2**23
"""Index of the random stream of the points; searches use those from 0 on."""


def noisy(context: Context) -> bool:
    """Whether each call of the system may give another result: as measured, as declared, or because the campaign
    states that an evaluation is several calls."""
    simulator = context.campaign.simulator
    if simulator is None:
        return False
    nominal = context.results.get(0)
    measured = None if nominal is None else nominal.repeatability
    repeats = context.problem.system.repeatable and (measured is None or measured.repeats)
    return simulator.calls > 1 or not repeats


def points(problem: Problem, most: int = POINTS) -> Floats:
    """The nominal point, and a Latin hypercube over the bounds, from the campaign's seed."""
    random = stream(problem.campaign.seed, STREAM)
    others, n = most - 1, problem.dimension
    strata = np.stack([random.permutation(others) for _ in range(n)], axis=1) if others else np.empty((0, n))
    return np.concatenate([problem.nominal_point[None, :], (strata + random.random((others, n))) / max(others, 1)])


def measuring(problem: Problem, chosen: Floats) -> Asking[str]:
    """Evaluate these points in used processes twice, the first one alone, then once more in fresh ones."""
    yield chosen[:1]
    yield chosen[1:]
    for _ in range(TIMES - 2):
        yield chosen
    fresh = slotted(problem.system).fresh()
    try:
        yield Through(chosen, fresh)
    finally:
        if fresh is not problem.system:
            optional.close(fresh)
    return ends.MEASURED


def measured(columns: Columns, chosen: int, problem: Problem) -> Measured:
    """The noise that evaluations show; they are `TIMES` rounds of the same `chosen` points."""
    declared = problem.system.repeatable
    costs, status = (of.reshape(-1, chosen) for of in (columns.costs[:, 0], columns.status))
    values = np.where(status == OK, costs, np.nan)
    bits = np.where(status == OK, costs + 0.0, 0.0).view(np.int64)  # -0.0 is 0.0
    same = ((status == status[0]) & (bits == bits[0])).all(axis=1)
    identical = bool(same.all())
    several = (status == OK).sum(axis=0) > 1
    spread = deviation = None
    if several.any():
        some = values[:, several]
        some = some - np.nanmin(some, axis=0)  # so that equal values have no deviation by rounding
        spread = float(np.nanmax(some))
        deviation = float(np.sqrt(np.nanvar(some, axis=0, ddof=1).mean()))
    failed = int(np.count_nonzero((status != OK) & (status != EXCLUDED)))
    last = len(columns.seconds) - chosen - 1
    seconds = None if last < 1 else float(columns.seconds[: last + 1].max() - columns.seconds[0]) / last
    system, simulator = slotted(problem.system), problem.campaign.simulator
    slots = max(system.slots, 1)
    calls = 1 if simulator is None else simulator.calls
    call = call_seconds(columns, chosen, slots, calls)
    return Measured(
        points=chosen,
        evaluations=status.size,
        failed=failed,
        identical=identical,
        declared=declared,
        by_process=bool(same[:-1].all()) and not identical,
        spread=spread,
        deviation=deviation,
        seconds=seconds,
        call_seconds=call,
        slots=None if call is None else slots,
        start_seconds=start_seconds(columns, chosen, slots, calls) if system.slots else None,
        recycle=system.recycle or None,
        statement=sentences.measured(chosen, status.size, failed, identical, declared, spread, problem.unit),
    )


def call_seconds(columns: Columns, chosen: int, slots: int, calls: int) -> float | None:
    """Time of one call [s], from the second round: its processes were used before, and it begins when all are idle.

    The calls of a round go through the slots in turns, and the time is that of a turn: a call is rather faster.
    """
    ended = columns.seconds
    if len(ended) < 2 * chosen:
        return None
    took = float(ended[chosen : 2 * chosen].max() - ended[:chosen].max())
    return took / -(-chosen * calls // slots) if took > 0.0 else None


def start_seconds(columns: Columns, chosen: int, slots: int, calls: int) -> float | None:
    """Time that the start of a process adds to a call [s], from the last round, in which each has a process of its own.

    None where it was not measured; 0 if the last round was no slower, as where each call has its own process anyway.
    """
    call, ended = call_seconds(columns, chosen, slots, calls), columns.seconds
    if call is None or len(ended) < TIMES * chosen:
        return None
    took = float(ended[-chosen:].max() - ended[:-chosen].max())
    return max(took / -(-chosen * calls // slots) - call, 0.0)


def reasons(columns: Columns) -> list[str]:
    """The distinct reasons of evaluations that failed or were excluded."""
    return list(dict.fromkeys(why for row, why in sorted(columns.reasons.items()) if columns.status[row] != OK))


def failures(columns: Columns) -> list[str]:
    """The distinct reasons of evaluations that failed."""
    failed = {row: why for row, why in columns.reasons.items() if columns.status[row] != EXCLUDED}
    return reasons(columns._replace(reasons=failed))


def exclusions(columns: Columns) -> Counter[str]:
    """How many evaluations were excluded for each reason."""
    return Counter(columns.reasons.get(int(row), "") for row in np.flatnonzero(columns.status == EXCLUDED))


def flaky(columns: Columns) -> int:
    """How many of these evaluations are ok only because a failed call was tried again."""
    return sum(columns.status[row] == OK and why.startswith(FLAKY) for row, why in columns.reasons.items())
