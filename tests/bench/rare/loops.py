"""The estimate on closed loops of the library, against plain samples: `python -m tests.bench.rare --loops`.

The threshold is the quantile of a plain sample, so that P is known with its Clopper-Pearson interval; the violations
are the lowest points of a tenth of that sample, at most four of them, apart from each other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import special

from campaigns import library, load_file
from campaigns.results.base import EXCLUDED, OK
from tests.bench.rare.judge import BUDGET, carried_out
from tests.bench.rare.problem import Floats
from worker.engine.problem.problem import Problem
from worker.engine.rare.estimate import Estimate, estimated
from worker.engine.search.parts.proportion import interval
from worker.running.opening import opened

CAMPAIGNS = ("uav_static", "uav_aca", "pioneer_moving", "unicycle_static", "uav_three_intruders")
SAMPLE, BLOCK = 500_000, 20_000
FRACTIONS, SEEDS = (1e-2, 1e-3, 2e-4), (1, 2)
STARTS, APART = 4, 0.15
"""Of the lowest points, and by how much of a range they differ."""


def measured() -> list[dict[str, Any]]:
    """A row per campaign, threshold and seed."""
    return [row for name in CAMPAIGNS for row in _of_campaign(name)]


def _of_campaign(name: str) -> list[dict[str, Any]]:
    problem = opened.problem(load_file(library()[name]))
    random = np.random.default_rng(1)
    points = random.random((SAMPLE, problem.dimension))
    costs = np.concatenate([_costs(problem, some) for some in np.split(points, SAMPLE // BLOCK)])
    rows = []
    for threshold in np.quantile(costs, FRACTIONS):
        starts = _lowest(points[: SAMPLE // 10], costs[: SAMPLE // 10], float(threshold))
        low, high = interval(int(np.count_nonzero(costs <= threshold)), SAMPLE, 0.95)
        for seed in SEEDS if len(starts) else ():
            asking = estimated(special.ndtri(starts), float(threshold), BUDGET, np.random.default_rng(seed))
            found, _ = carried_out(asking, lambda u: _costs(problem, special.ndtr(u)))
            assert isinstance(found, Estimate)
            rows.append(_row(name, problem.dimension, (low, high), found))
    return rows


def _row(name: str, dimension: int, sampled: tuple[float, float], found: Estimate) -> dict[str, Any]:
    own, (low, high) = found.interval, sampled
    row = {
        "campaign": name,
        "parameters": dimension,
        "sampled": sampled,
        "estimated": (own.low, own.probability, own.high),
        "overlap": own.low <= high and own.high >= low,
        "shares": [mode.share for mode in found.modes],
        "alarms": [alarm.why for alarm in found.alarms],
    }
    print(
        f"{name:20} {dimension:2} parameters, sampled {low:.3g} to {high:.3g}, estimated {own.probability:.3g} "
        f"[{own.low:.3g}, {own.high:.3g}], {'overlap' if row['overlap'] else 'DIFFER'}, {len(found.modes)} modes, "
        f"alarms: {', '.join(row['alarms']) or 'none'}"
    )
    return row


def _costs(problem: Problem, uniform: Floats) -> Floats:
    """NaN where an evaluation failed, infinity where it was excluded."""
    batch, _ = problem.evaluate(problem.quantile(uniform))
    return np.where(batch.status == OK, batch.costs[:, 0], np.where(batch.status == EXCLUDED, np.inf, np.nan))


def _lowest(points: Floats, costs: Floats, threshold: float) -> Floats:
    found: list[Floats] = []
    for i in np.argsort(costs):
        if costs[i] > threshold or len(found) == STARTS:
            break
        if all(np.abs(points[i] - other).max() > APART for other in found):
            found.append(points[i])
    return np.array(found)
