"""How sure a search by `auto` is: the chance that another one of the same budget finds a lower case.

A logistic regression (Cox 1958) on what the search left in its stored evaluations. Nothing here is a bound, and no
check rests on it. Start reading at `sureness`; the coefficients are `MODEL` and `LOW`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns import limits, rules
from campaigns.claims import sureness as templates
from campaigns.results import StageResult
from campaigns.results.base import OK
from campaigns.results.sureness import Sureness
from campaigns.stages.plan import plan
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem

Floats = NDArray[np.float64]


class Model(NamedTuple):
    """The coefficients, and the landscapes on which they were set."""

    landscapes: int
    constant: float
    near: float


MODEL = Model(landscapes=321, constant=-0.297, near=-1.325)
"""Set by maximum likelihood on 2,916 statements: of two searches on landscapes 0 to 162 and 170 to 327 of the half for
setting of `tests/given/landscapes.py`, at 50 to 2,000 evaluations per parameter. Standard deviations 0.11 and 0.09, by
bootstrap over landscapes. `python -m tests.bench.scoreboard.fitted` sets them anew; docs/methods.md states how they
were judged."""

LOW, FEW = Model(landscapes=434, constant=-0.898, near=-1.586), 3
"""The same up to so many parameters, where `auto` begins in another way: on 3,478 statements on the landscapes with 3
parameters among 0 to 1,574."""

PARAMETERS, EVALUATIONS = (2, 20), (50, 2500)
"""Parameters, and evaluations for each of them, outside of which there is no number. It was set on 3 to 18 parameters
and judged on 2 to 20, on 50 to 2,000 evaluations; the usual budget of two parameters is 2,500 for each."""
SECONDS = 0.02
"""Time of an evaluation [s] from which `auto` searches in another way, on which nothing was set."""
ENOUGH = 100
"""Evaluations as low as the lowest beyond which more of them say nothing more."""


class Stored(NamedTuple):
    """The evaluations of one stage: costs (m, k), status (m,)."""

    costs: Floats
    status: NDArray[np.uint8]

    @staticmethod
    def of(columns: Columns) -> Stored:
        """Of the store's columns."""
        return Stored(columns.costs, columns.status)


def sureness(
    problem: Problem, results: Sequence[StageResult], stored: Mapping[int, Stored], landscapes: int | None = None
) -> Sureness | None:
    """The estimate from the evaluations of the stages by position; None where nothing is known.

    landscapes: on how many that of a record was set, which may have been before there was `LOW`.
    """
    position = _searched(problem, stored)
    nominal = next((r.at_nominal.cost for r in results if r.at_nominal is not None), None)
    if position is None or nominal is None or not _repeats(problem, results):
        return None
    costs, status = stored[position]
    ranked = np.where(status == OK, costs[:, 0], np.inf)
    lowest = float(ranked.min())
    lower = rules.SAME_COST.value * (nominal - lowest)
    if not rules.ROUNDING.value * max(abs(nominal), abs(lowest)) < lower < np.inf:
        return None
    coefficients = MODEL if landscapes == MODEL.landscapes else model(problem.dimension)
    probability = chance(ranked, nominal, coefficients)
    statement = templates.sureness(probability, lower, problem.unit, coefficients.landscapes)
    return Sureness(chance=probability, lower=lower, landscapes=coefficients.landscapes, statement=statement)


def _searched(problem: Problem, stored: Mapping[int, Stored]) -> int | None:
    """The position of the one search, if it is one on which the estimate was set: `auto` alone, of one criterion, that
    used its whole budget."""
    campaign, searches = problem.campaign, [k for k, planned in enumerate(plan(problem.campaign)) if planned.method]
    if len(searches) != 1 or campaign.objectives:
        return None
    (request,), (position,) = campaign.stages.search, searches
    each = request.evaluations / problem.dimension
    known = PARAMETERS[0] <= problem.dimension <= PARAMETERS[1] and EVALUATIONS[0] <= each <= EVALUATIONS[1]
    fast = float(request.options.get("seconds", 0.0)) < SECONDS
    whole = position in stored and len(stored[position].status) == request.evaluations
    return position if request.method == limits.SEARCH and known and fast and whole else None


def _repeats(problem: Problem, results: Sequence[StageResult]) -> bool:
    measured = next((r.at_nominal.measured for r in results if r.at_nominal is not None), None)
    simulator = problem.campaign.simulator
    return simulator is None or (simulator.calls == 1 and measured is not None and measured.repeats)


def model(parameters: int) -> Model:
    """The coefficients for so many parameters."""
    return LOW if parameters <= FEW else MODEL


def chance(ranked: Floats, nominal: float, coefficients: Model) -> float:
    """The chance from costs (m,) of a search, infinite where there is none; at least one is below nominal."""
    return 1.0 / (1.0 + math.exp(-coefficients.constant - coefficients.near * near(ranked, nominal)))


def near(ranked: Floats, nominal: float) -> float:
    """The logarithm of the number of evaluations that are as low as the lowest, up to a hundred.

    As Good and Turing judge by what was seen once (Good 1953): a lowest cost that one evaluation has can be undercut.
    """
    lowest = float(ranked.min())
    as_low = np.count_nonzero((ranked - lowest) / (nominal - lowest) <= rules.SAME_COST.value)
    return math.log10(min(int(as_low), ENOUGH))
