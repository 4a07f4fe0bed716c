"""One run of the estimate on one problem, and what many of them come to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from campaigns.results.base import EXCLUDED, FAILED, OK
from tests.bench.rare.problem import Floats, Problem
from tests.bench.rare.starts import starts
from worker.engine.rare.estimate import Estimate, estimated
from worker.engine.rare.evaluated import Asking
from worker.engine.search.base import Batch

T = TypeVar("T")

BUDGET = 5000
LARGE = 0.1
"""The share of P above which a withheld mode must not go unnoticed."""


@dataclass(frozen=True)
class Outcome:
    """A run: the withheld mode's share of P (0: none withheld) and whether it was found, and the result."""

    problem: str
    half: str
    dimension: int
    withheld: float
    found: bool
    ratio: float
    high: float
    holds: bool
    variation: float
    alarms: tuple[str, ...]
    modes: int
    evaluations: int


def outcomes(problem: Problem, seeds: Sequence[int]) -> list[Outcome]:
    """With all modes given, and with each one withheld."""
    withheld = [None, *(range(len(problem.modes)) if len(problem.modes) > 1 else ())]
    return [outcome(problem, mode, seed) for mode in withheld for seed in seeds]


def outcome(problem: Problem, withheld: int | None, seed: int, budget: int = BUDGET) -> Outcome:
    """One run; every point that it requests is counted."""
    points = starts(problem) if withheld is None else np.delete(starts(problem), withheld, axis=0)
    random = np.random.default_rng([seed, *problem.name.encode(), 0 if withheld is None else 1 + withheld])
    estimate, evaluations = carried_out(estimated(points, 0.0, budget, random), problem.costs)
    assert isinstance(estimate, Estimate), estimate
    return _judged(problem, withheld, estimate, evaluations)


def carried_out(asking: Asking[T], costs: Callable[[Floats], Floats]) -> tuple[T, int]:
    """What it returns, and how many points it requested; a cost of NaN is a failed evaluation, infinity an excluded
    one."""
    requested, batch = 0, None
    while True:
        try:
            points = next(asking) if batch is None else asking.send(batch)
        except StopIteration as end:
            return end.value, requested
        requested += len(points)
        values = costs(points)
        status = np.select([np.isnan(values), values == np.inf], [FAILED, EXCLUDED], OK).astype(np.uint8)
        batch = Batch(np.where(status == OK, values, np.nan)[:, None], status)


def _judged(problem: Problem, withheld: int | None, estimate: Estimate, evaluations: int) -> Outcome:
    own = estimate.interval
    mode = None if withheld is None else problem.modes[withheld]
    designs = np.array([m.design for m in estimate.modes])
    return Outcome(
        problem.name,
        problem.half,
        problem.dimension,
        mode.probability / problem.probability if mode else 0.0,
        bool(mode and (mode.limit(designs) <= 0.01).any()),
        own.probability / problem.probability,
        own.high / problem.probability,
        own.low <= problem.probability <= own.high,
        own.variation,
        tuple(alarm.why for alarm in estimate.alarms),
        len(estimate.modes),
        evaluations,
    )


def figures(runs: Sequence[Outcome]) -> dict[str, Any]:
    """What the runs come to: fractions, of all runs, of those without an alarm (also with nothing withheld), of those
    with a withheld mode of a tenth of P or more (found or alarm; alarm), of those with nothing withheld."""
    whole, large = [r for r in runs if not r.withheld], [r for r in runs if r.withheld > LARGE]
    silent = [r for r in runs if not r.alarms]
    return {
        "runs": len(runs),
        "holds_or_alarm": _part([r.holds or bool(r.alarms) for r in runs]),
        "holds_without_alarm": _part([r.holds for r in silent]),
        "holds_nothing_withheld": _part([r.holds for r in silent if not r.withheld]),
        "large_withheld": len(large),
        "large_noticed": _part([r.found or bool(r.alarms) for r in large]),
        "large_alarm": _part([bool(r.alarms) for r in large]),
        "false_alarms": _part([bool(r.alarms) for r in whole]),
        "most_evaluations": max(r.evaluations for r in runs),
        "median_variation": float(np.median([r.variation for r in silent])),
        "largest_variation": max(r.variation for r in silent),
    }


def _part(of: Sequence[bool]) -> float | None:
    return float(np.mean(of)) if of else None
