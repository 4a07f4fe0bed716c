"""How sure a search by `auto` is: the chance that another one of the same budget finds a lower case.

A logistic regression (Cox 1958) on what the search left in its stored evaluations. Nothing here is a bound, and no
check rests on it. Start reading at `sureness`; the coefficients are `MODEL`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns import rules
from campaigns.claims import sureness as templates
from campaigns.results import SearchResult, StageResult
from campaigns.results.base import OK
from campaigns.results.sureness import Sureness
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.store import Columns

Floats = NDArray[np.float64]


class Model(NamedTuple):
    """The coefficients by feature, and the landscapes on which they were set."""

    landscapes: int
    constant: float
    coefficients: Mapping[str, float]


MODEL = Model(landscapes=0, constant=-2.0, coefficients={"near": -0.5, "rival": -0.5, "late": 0.5})
"""Set by maximum likelihood on pairs of searches."""

METHOD = "auto"
PARAMETERS, EVALUATIONS = (2, 20), (50, 2500)
"""Parameters, and evaluations for each of them, of the searches on which it was set and judged: elsewhere there is no
number."""
SECONDS = 0.02
"""Time of an evaluation [s] from which `auto` searches in another way, on which nothing was set."""
ELSEWHERE, FURTHEST = 0.1, 2.0
"""Fraction of any range beyond which an evaluation is elsewhere than the best; differences of costs count up to this
multiple of nominal minus the lowest."""
LEAST, MOST = 0.01, 0.99
"""What so many landscapes can distinguish from 0 and from 1."""


class Stored(NamedTuple):
    """The evaluations of one stage in their order: points (m, n) of the unit cube, costs (m, k), status (m,)."""

    points: Floats
    costs: Floats
    status: NDArray[np.uint8]

    @staticmethod
    def of(columns: Columns) -> Stored:
        """Of the store's columns."""
        return Stored(columns.points, columns.costs, columns.status)


def sureness(problem: Problem, results: Sequence[StageResult], stored: Mapping[int, Stored]) -> Sureness | None:
    """The estimate from the evaluations of the stages by position; None where nothing is known."""
    position = _searched(problem, results)
    nominal = next((r.at_nominal.cost for r in results if r.at_nominal is not None), None)
    if position is None or nominal is None:
        return None
    points, costs, status = stored[position]
    ranked = np.where(status == OK, costs[:, 0], np.inf)
    lowest = float(ranked.min())
    lower = rules.SAME_COST.value * (nominal - lowest)
    if not rules.ROUNDING.value * max(abs(nominal), abs(lowest)) < lower < np.inf:
        return None
    probability = chance(points, ranked, nominal)
    statement = templates.sureness(probability, lower, problem.unit, MODEL.landscapes)
    return Sureness(chance=probability, lower=lower, landscapes=MODEL.landscapes, statement=statement)


def _searched(problem: Problem, results: Sequence[StageResult]) -> int | None:
    """The position of the one search, if it is one on which the estimate was set: `auto` alone, of one criterion, that
    used its whole budget, on a system whose results repeat."""
    campaign, searches = problem.campaign, [k for k, r in enumerate(results) if isinstance(r, SearchResult)]
    if len(searches) != 1 or campaign.objectives:
        return None
    result, request = results[searches[0]], campaign.stages.search[0]
    assert isinstance(result, SearchResult)
    each = request.evaluations / problem.dimension
    known = PARAMETERS[0] <= problem.dimension <= PARAMETERS[1] and EVALUATIONS[0] <= each <= EVALUATIONS[1]
    fast = float(request.options.get("seconds", 0.0)) < SECONDS
    whole = result.evaluations == request.evaluations
    return searches[0] if result.method == METHOD and known and fast and whole and _repeats(problem, results) else None


def _repeats(problem: Problem, results: Sequence[StageResult]) -> bool:
    measured = next((r.at_nominal.measured for r in results if r.at_nominal is not None), None)
    simulator = problem.campaign.simulator
    return simulator is None or (simulator.calls == 1 and measured is not None and measured.repeats)


def chance(points: Floats, ranked: Floats, nominal: float) -> float:
    """The chance from points (m, n) and costs (m,) in the order of the search, infinite where there is none; at least
    one is below nominal."""
    found = features(points, ranked, nominal)
    z = MODEL.constant + sum(c * found[name] for name, c in MODEL.coefficients.items())
    return min(max(1.0 / (1.0 + math.exp(-z)), LEAST), MOST)


def features(points: Floats, ranked: Floats, nominal: float) -> dict[str, float]:
    """What the estimate rests on; differences of costs are fractions of nominal minus the lowest.

    near: the fraction of the evaluations that are nearly as low as the lowest, the lower tail of all costs: a valley
    that is explored has many. rival: how much higher the lowest evaluation elsewhere is: what is nearly as low may have
    been searched less. late: by how much the last quarter improved the lowest cost: what still falls has not ended.
    """
    best = int(np.argmin(ranked))
    lowest = float(ranked[best])
    above = (ranked - lowest) / (nominal - lowest)
    elsewhere = above[np.abs(points - points[best]).max(axis=1) > ELSEWHERE]
    before = above[: 3 * len(above) // 4]
    return {
        "near": math.log10(np.count_nonzero(above <= rules.SAME_COST.value) / len(above)),
        "rival": math.log10(1e-3 + min(float(elsewhere.min(initial=np.inf)), FURTHEST)),
        "late": math.log10(1e-4 + min(float(before.min(initial=np.inf)), FURTHEST)),
    }
