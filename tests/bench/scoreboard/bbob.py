"""BBOB: the 24 noiseless functions of Hansen et al. (2009) over [-5, 5]^n, taken as the unit cube, from `ioh`.

The figure is the share of the 51 targets 10^2, 10^1.8, ... 10^-8 above the optimum that a search has reached, averaged
over functions and instances, at so many evaluations per parameter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from multiprocessing import get_context
from typing import Any

import numpy as np

from tests.bench.scoreboard import peers
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.contestants import LIMITS, Contestant
from tests.bench.scoreboard.parts import Part, Request, Table, averaged
from tests.bench.scoreboard.searches import Trace
from tests.given.landscapes import Half
from worker.engine.search.base import Floats

TARGETS = 10.0 ** (2.0 - 0.2 * np.arange(51))
FUNCTIONS = tuple(range(1, 25))
DIMENSIONS = (2, 5, 10, 20)
SLOW = 10
"""Dimensions up to which those with a limit (`contestants.LIMITS`) take part, in the first instance."""
BUDGETS = (100, 200, 1000)
"""Evaluations per parameter."""
INSTANCES: dict[Half, tuple[int, ...]] = {"setting": tuple(range(1, 16)), "judging": tuple(range(101, 116))}
"""Fifteen, as in COCO, of each function in two parameters; the first `FEW` in more, where a search takes longer."""
FEW = 3


class OnCube:
    """One instance of a function over the unit cube; its values are above the optimum, 0."""

    def __init__(self, function: int, instance: int, dimension: int) -> None:
        ioh = peers.module("ioh")
        self.problem = ioh.get_problem(function, instance, dimension, ioh.ProblemClass.BBOB)
        self.optimum = float(self.problem.optimum.y)

    def __call__(self, points: Floats) -> Floats:
        """Values (m,) above the optimum at points (m, n)."""
        return np.array(self.problem(np.ascontiguousarray(10.0 * points - 5.0))) - self.optimum


def available() -> bool:
    """Whether the package of the functions is installed."""
    peers.allow()
    return find_spec("ioh") is not None


def reached(precision: float) -> float:
    """The share of the targets at or above this distance from the optimum."""
    return float((precision <= TARGETS).mean())


def precisions(
    method: str,
    function: int,
    instance: int,
    dimension: int,
    budgets: Sequence[int],
    options: Mapping[str, object] | None = None,
) -> dict[int, float]:
    """The least distance from the optimum by evaluations per parameter, on one instance."""
    traces = _traces(Contestant(method, options or {}), function, instance, dimension, budgets)
    return {budget: traces[budget].lowest(budget * dimension) for budget in traces}


def _traces(
    contestant: Contestant, function: int, instance: int, dimension: int, budgets: Sequence[int]
) -> dict[int, Trace]:
    sizes = [budget * dimension for budget in budgets]
    found = contestant.traces(OnCube(function, instance, dimension), dimension, sizes, seed(function, instance))
    return {size // dimension: trace for size, trace in found.items()}


def seed(function: int, instance: int) -> int:
    """The seed of a search: another one for every function and instance."""
    return 1000 * instance + function


def share(
    method: str,
    functions: Iterable[int] = FUNCTIONS,
    instances: Iterable[int] = INSTANCES["setting"][:FEW],
    dimension: int = 5,
    budgets: Sequence[int] = BUDGETS,
    options: Mapping[str, object] | None = None,
    processes: int = 1,
) -> dict[int, float]:
    """The share of targets reached by evaluations per parameter; a budget that the method does not take is left out."""
    one = partial(_precisions, method, dimension=dimension, budgets=tuple(budgets), options=dict(options or {}))
    problems = [(f, i) for f in functions for i in instances]
    if processes > 1:
        with get_context("spawn").Pool(processes) as pool:
            found = pool.map(one, problems, chunksize=1)
    else:
        found = list(map(one, problems))
    return {b: float(np.mean([reached(one[b]) for one in found])) for b in budgets if all(b in one for one in found)}


def _precisions(method: str, problem: tuple[int, int], **about: Any) -> dict[int, float]:
    return precisions(method, *problem, **about)


def _cells(request: Request) -> list[Cell]:
    budgets = request.budgets or BUDGETS
    return [
        Cell("bbob", request.half, method, str(function), dimension, instance, budgets)
        for dimension in DIMENSIONS
        for method in request.methods
        if method not in LIMITS or dimension <= SLOW
        for instance in INSTANCES[request.half][
            : 1 if method in LIMITS else FEW if dimension > min(DIMENSIONS) else None
        ]
        for function in FUNCTIONS
    ]


def _measure(cell: Cell) -> dict[str, Any]:
    traces = _traces(Contestant(cell.method), int(cell.problem), cell.number, cell.dimension, cell.budgets)
    return {
        "precision": {str(b): t.lowest(b * cell.dimension) for b, t in traces.items()},
        "own_us": max((1e6 * t.own / max(len(t.values), 1) for t in traces.values()), default=0.0),
        "error": next((t.error for t in traces.values() if t.error), ""),
    }


def _table(rows: Sequence[Row]) -> Table:
    def figures(row: Row) -> dict[str, float | None]:
        found = row.figures["precision"]
        return {
            f"{row.cell.dimension} parameters @ {b}": reached(found[str(b)]) if str(b) in found else None
            for b in row.cell.budgets
        }

    return averaged(rows, figures)


PART = Part(
    "bbob",
    "BBOB",
    "Fraction of 51 targets, 10^2 to 10^-8 above the optimum, that was reached, averaged over 24 functions and three "
    "instances of each, fifteen in two parameters (Hansen et al. 2009, functions from ioh), at so many evaluations per "
    "parameter. Methods start anywhere in the box.",
    _cells,
    _measure,
    _table,
)
