"""The estimate after a search, with starts that its stage chooses itself: `python -m tests.bench.rare --whole`.

The campaign has normal distributions that are truncated at six deviations, or uniform ones; `auto` searches it, and
`worker.engine.rare.starts` chooses among its evaluations. Nothing that is known of a problem is given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special

from clearance.testing.searching import run
from tests.bench.rare.judge import BUDGET, LARGE, carried_out
from tests.bench.rare.problem import Floats, Problem
from worker.engine.rare import starts
from worker.engine.rare.estimate import Estimate, Refused, estimated
from worker.running.catalogue.installed import methods

EACH, MOST = 500, 5000
"""Evaluations of the search for every parameter, and at most."""
CUBES: Mapping[str, Callable[[Floats], Floats]] = {
    "truncated": lambda cube: 12.0 * cube - 6.0,
    "uniform": lambda cube: np.asarray(special.ndtri(np.clip(cube, 1e-15, 1.0 - 1e-15))),
}
"""Points of the unit cube in standard normal space."""


@dataclass(frozen=True)
class Whole:
    """One run. large: modes of a tenth of P or more; given: of those that the starts violate; found: that are modes of
    the estimate; without a violation nothing is estimated."""

    problem: str
    cube: str
    starts: int
    refused: bool
    holds: bool
    alarms: tuple[str, ...]
    ratio: float
    large: int
    given: int
    found: int


def whole(problem: Problem, cube: str, seed: int) -> Whole:
    """A search and the estimate that follows."""
    normal = CUBES[cube]
    auto = next(method for method in methods().values() if method.name == "auto")
    budget = min(MOST, EACH * problem.dimension)
    searched = run(auto, lambda points: problem.costs(normal(points)), problem.dimension, budget, seed=seed)
    points, costs = searched.points[:budget], np.concatenate(searched.values)[:budget]
    violations = np.flatnonzero(costs <= 0.0)
    stored = np.clip(normal(points[violations]), -6.0, 6.0)
    known = starts.Stored(points[violations], costs[violations], stored, np.zeros(len(stored), dtype=bool))
    given = stored[starts.chosen(known, BUDGET)]
    random = np.random.default_rng([seed, *problem.name.encode(), *cube.encode()])
    made: Estimate | Refused = Refused("no_violation")
    if len(given):
        made, _ = carried_out(estimated(given, 0.0, BUDGET, random, stored=stored), problem.costs)
    large = [mode for mode in problem.modes if mode.probability > LARGE * problem.probability]
    of_starts = sum(bool((mode.limit(given) <= 0.0).any()) for mode in large)
    if isinstance(made, Refused):
        return Whole(problem.name, cube, len(given), True, True, (), 0.0, len(large), of_starts, 0)
    designs, own = np.array([mode.design for mode in made.modes]), made.interval
    return Whole(
        problem.name,
        cube,
        len(given),
        False,
        own.low <= problem.probability <= own.high,
        tuple(alarm.why for alarm in made.alarms),
        own.probability / problem.probability,
        len(large),
        of_starts,
        sum(bool((mode.limit(designs) <= 0.01).any()) for mode in large),
    )


def measured(problems: Sequence[Problem], seeds: Sequence[int]) -> dict[str, Any]:
    """The figures of each kind of campaign; prints them, and the runs whose interval fails without an alarm."""
    found: dict[str, Any] = {}
    for cube in CUBES:
        wholes = [whole(problem, cube, seed) for problem in problems for seed in seeds]
        made = [one for one in wholes if not one.refused]
        large = sum(one.large for one in made)
        found[cube] = {
            "runs": len(wholes),
            "no_violation": len(wholes) - len(made),
            "holds_or_alarm": float(np.mean([one.holds or bool(one.alarms) for one in made])),
            "alarms": float(np.mean([bool(one.alarms) for one in made])),
            "large_given": sum(one.given for one in made) / large,
            "large_noticed": sum(one.large if one.alarms else one.found for one in made) / large,
            "median_starts": float(np.median([one.starts for one in made])),
        }
        print(cube, " ".join(f"{name} {value:.4g}" for name, value in found[cube].items()))
        for one in made:
            if not one.alarms and not one.holds:
                print(f"  does not hold, no alarm: {one.problem}, P {one.ratio:.2f}, modes {one.found}/{one.large}")
    return found
