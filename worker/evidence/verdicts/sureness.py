"""How sure a search by `auto` is: the chance that another one of the same budget finds a lower case.

A logistic regression (Cox 1958) on what the search left in its stored evaluations. Nothing here is a bound, and no
check rests on it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns import limits, rules
from campaigns.claims import sureness as templates
from campaigns.cube import Floats
from campaigns.results import StageResult
from campaigns.results.base import OK
from campaigns.results.sureness import Sureness
from campaigns.stages.plan import plan
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.scales import far_above


class Model(NamedTuple):
    """The coefficients, and the landscapes on which they were set.

    enough: evaluations as low as the lowest beyond which more of them say nothing more. parameters: the fewest and the
    most that these landscapes have; None of earlier versions, whose sentences are not made again.
    """

    landscapes: int
    constant: float
    near: float
    enough: int = 100
    parameters: tuple[int, int] | None = None


MODEL = Model(landscapes=696, constant=-0.466, near=-1.231, parameters=(5, 18))
"""Set by maximum likelihood on 5,496 statements: of two searches on those of the first 1,020 landscapes of the score
board's half for setting (`tests/bench/scoreboard/sureness.py`) that have more than three parameters, at 50 to 2,000
evaluations per parameter. `python -m tests.bench.scoreboard.fitted` sets them; docs/methods.md states how they were
judged."""

LOW, FEW = Model(landscapes=324, constant=-0.689, near=-3.026, enough=10, parameters=(3, 3)), 3
"""The same up to so many parameters, where `auto` begins in another way: on 2,598 statements."""

FORMER, FORMER_LOW = Model(321, -0.297, -1.325), Model(434, -0.898, -1.586)
"""Of records of earlier versions, whose `auto` was another one."""

PARAMETERS, EVALUATIONS = (2, 20), (50, 2500)
"""Parameters, and evaluations for each of them, outside of which there is no number. It was set on 3 to 18 parameters
and judged on 2 to 20, on 50 to 2,000 evaluations; the usual budget of two parameters is 2,500 for each."""
HALF = 0.5
"""The fraction of the evaluations that must have a value: where more failed, almost nothing was judged."""
SECONDS = 0.02
"""Time of an evaluation [s] from which `auto` searches in another way, on which nothing was set."""


class Stored(NamedTuple):
    """The evaluations of one stage: costs (m, k), status (m,)."""

    costs: Floats
    status: NDArray[np.uint8]


def sureness(
    problem: Problem, results: Sequence[StageResult], stored: Mapping[int, Stored], landscapes: int | None = None
) -> Sureness | None:
    """The estimate from the evaluations of the stages by position; None where nothing is known.

    landscapes: on how many that of a record was set, which may be of an earlier version.
    """
    position = _searched(problem, stored)
    nominal = next((r.at_nominal.cost for r in results if r.at_nominal is not None), None)
    if position is None or nominal is None or _in_slots(results):
        return None
    costs, status = stored[position]
    if np.count_nonzero(status == OK) < HALF * len(status):
        return None
    ranked = np.where(status == OK, costs[:, 0], np.inf)
    lowest = float(ranked.min())
    if far_above(ranked, lowest, nominal - lowest):
        return None
    lower = rules.SAME_COST.value * (nominal - lowest)
    if not rules.ROUNDING.value * max(abs(nominal), abs(lowest)) < lower < np.inf:
        return None
    known = min(float(costs[status == OK, 0].min(initial=np.inf)) for costs, status in stored.values())
    if lowest - known > lower:  # another stage has found what the number would state the chance of
        return None
    coefficients = model(problem.dimension, landscapes)
    probability = chance(ranked, nominal, coefficients)
    statement = templates.sureness(probability, lower, problem.unit, coefficients.landscapes, coefficients.parameters)
    return Sureness(chance=probability, lower=lower, landscapes=coefficients.landscapes, statement=statement)


def _searched(problem: Problem, stored: Mapping[int, Stored]) -> int | None:
    """The position of the one search, if it is one on which the estimate was set: `auto` alone, of one criterion, that
    used its whole budget and whose evaluations are single calls."""
    campaign, searches = problem.campaign, [k for k, planned in enumerate(plan(problem.campaign)) if planned.method]
    called = 1 if campaign.simulator is None else campaign.simulator.calls
    if len(searches) != 1 or campaign.objectives or called > 1:
        return None
    (request,), (position,) = campaign.stages.search, searches
    each = request.evaluations / problem.dimension
    known = PARAMETERS[0] <= problem.dimension <= PARAMETERS[1] and EVALUATIONS[0] <= each <= EVALUATIONS[1]
    fast = float(request.options.get("seconds", 0.0)) < SECONDS and request.options.get("at_once", 1) == 1
    whole = position in stored and len(stored[position].status) == request.evaluations
    return position if request.method == limits.SEARCH and known and fast and whole else None


def _in_slots(results: Sequence[StageResult]) -> bool:
    """Whether evaluations ran in slots, however many, where members of `auto` have other shares: only then is the start
    of a process measured."""
    measured = (r.repeatability for r in results)
    return any(of is not None and (of.start_seconds is not None or (of.slots or 1) > 1) for of in measured)


def model(parameters: int, landscapes: int | None = None) -> Model:
    """The coefficients for so many parameters; those of an earlier version if it set them on so many landscapes."""
    few = parameters <= FEW
    former = {one.landscapes: one for one in ((FORMER, FORMER_LOW) if few else (FORMER,))}
    return former.get(landscapes or 0, LOW if few else MODEL)


def chance(ranked: Floats, nominal: float, coefficients: Model) -> float:
    """The chance from costs (m,) of a search, infinite where there is none; at least one is below nominal."""
    near = coefficients.near * math.log10(min(as_low(ranked, nominal), coefficients.enough))
    return 1.0 / (1.0 + math.exp(-coefficients.constant - near))


def as_low(ranked: Floats, nominal: float) -> int:
    """The number of evaluations that are as low as the lowest.

    As Good and Turing judge by what was seen once (Good 1953): a lowest cost that one evaluation has can be undercut.
    """
    lowest = float(ranked.min())
    return int(np.count_nonzero((ranked - lowest) / (nominal - lowest) <= rules.SAME_COST.value))
