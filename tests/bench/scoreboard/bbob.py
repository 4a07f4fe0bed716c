"""BBOB: the 24 noiseless functions of Hansen et al. (2009) over [-5, 5]^n, taken as the unit cube, from `ioh`.

The figure is the share of the 51 targets 10^2, 10^1.8, ... 10^-8 above the optimum that a search has reached, averaged
over functions and instances, at so many evaluations per parameter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np

from tests.bench.scoreboard import peers
from tests.bench.scoreboard.contestants import Contestant
from worker.engine.search.base import Floats

TARGETS = 10.0 ** (2.0 - 0.2 * np.arange(51))
FUNCTIONS = tuple(range(1, 25))
DIMENSIONS = (2, 5, 10, 20)
BUDGETS = (100, 200, 1000)
"""Evaluations per parameter."""
INSTANCES = {"setting": (1, 2, 3), "judging": (101, 102, 103)}


class OnCube:
    """One instance of a function over the unit cube; its values are above the optimum, 0."""

    def __init__(self, function: int, instance: int, dimension: int) -> None:
        ioh = peers.module("ioh")
        self.problem = ioh.get_problem(function, instance, dimension, ioh.ProblemClass.BBOB)
        self.optimum = float(self.problem.optimum.y)

    def __call__(self, points: Floats) -> Floats:
        """Values (m,) above the optimum at points (m, n)."""
        return np.array(self.problem(np.ascontiguousarray(10.0 * points - 5.0))) - self.optimum


class Run(NamedTuple):
    """One method on one instance; options as pairs."""

    method: str
    function: int
    instance: int
    dimension: int
    budgets: tuple[int, ...]
    options: tuple[tuple[str, object], ...] = ()


def reached(precision: float) -> float:
    """The share of the targets at or above this distance from the optimum."""
    return float((precision <= TARGETS).mean())


def precisions(run: Run) -> tuple[dict[int, float], float]:
    """The least distance from the optimum by evaluations per parameter, and own time per evaluation [us]."""
    function = OnCube(run.function, run.instance, run.dimension)
    sizes = [budget * run.dimension for budget in run.budgets]
    contestant = Contestant(run.method, dict(run.options))
    lowest, own = contestant.lowest(function, run.dimension, sizes, seed(run.function, run.instance))
    return {size // run.dimension: value for size, value in lowest.items()}, own


def seed(function: int, instance: int) -> int:
    """The seed of a search: another one for every function and instance."""
    return 1000 * instance + function


def share(
    method: str,
    functions: Iterable[int] = FUNCTIONS,
    instances: Iterable[int] = INSTANCES["setting"],
    dimension: int = 5,
    budgets: Sequence[int] = BUDGETS,
    options: Mapping[str, object] | None = None,
    processes: int = 1,
) -> dict[int, float]:
    """The share of targets reached by evaluations per parameter; a budget that the method does not take is left out."""
    chosen = tuple((options or {}).items())
    runs = [Run(method, f, i, dimension, tuple(budgets), chosen) for f in functions for i in instances]
    if processes > 1:
        with get_context("spawn").Pool(processes) as pool:
            found = [lowest for lowest, _ in pool.map(precisions, runs, chunksize=1)]
    else:
        found = [precisions(run)[0] for run in runs]
    return {b: float(np.mean([reached(one[b]) for one in found])) for b in budgets if all(b in one for one in found)}
