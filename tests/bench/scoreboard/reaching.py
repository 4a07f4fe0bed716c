"""Parts whose problems have a target: the random landscapes, the shipped closed loops, the falsification problems."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache, partial
from typing import Any

import numpy as np

from campaigns import library, load_file
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from clearance.testing.searching import Function
from tests.bench.scoreboard.cells import ROOT, Cell, Row
from tests.bench.scoreboard.contestants import Contestant, fast
from tests.bench.scoreboard.parts import Part, Request, Table, averaged
from tests.given.falsification import PROBLEMS
from tests.given.landscapes import KINDS, landscape
from worker.engine.search.base import Floats

BUDGETS = (100, 200, 1000)
SIMULATIONS = (30, 100)
"""Of the falsification problems: 240 to 1,000 simulations, as the competition permits 300 to 1,500."""
FIRST_SEED = {"setting": 1, "judging": 5001}
"""Of the searches; the halves never share one."""
VERDICTS = ROOT / "tests" / "golden" / "library_verdicts.json"
WITHIN = 0.01
"""Of nominal less worst: how close to the worst case of a closed loop counts as having found it."""


def reached(cell: Cell, function: Function, targets: dict[str, float], seed: int) -> dict[str, Any]:
    """Whether each target was reached, by budget; targets by what their column adds to the name of the problem.

    The search ends at the lowest of them.
    """
    sizes = [budget * cell.dimension for budget in cell.budgets]
    traces = Contestant(cell.method).traces(function, cell.dimension, sizes, seed, stop=min(targets.values()))
    lowest = {str(size // cell.dimension): trace.lowest(size) for size, trace in traces.items()}
    return {
        "reached": {name: {b: bool(low <= target) for b, low in lowest.items()} for name, target in targets.items()},
        "lowest": {b: low if np.isfinite(low) else None for b, low in lowest.items()},
        "error": next((trace.error for trace in traces.values() if trace.error), ""),
    }


def table(rows: Sequence[Row]) -> Table:
    """The fraction of seeds that reached the target, by problem and budget, and of all problems."""

    def figures(row: Row) -> dict[str, float | None]:
        return {
            f"{group}{name} @ {b}": reached_at.get(str(b))
            for name, reached_at in row.figures["reached"].items()
            for b in row.cell.budgets
            for group in ("all", row.cell.problem)
        }

    return averaged(rows, figures)


def seeds(request: Request) -> range:
    """The seeds of the searches of a half."""
    return range(FIRST_SEED[request.half], FIRST_SEED[request.half] + request.seeds)


def _landscapes(request: Request) -> list[Cell]:
    budgets, kinds = request.budgets or BUDGETS, list(KINDS)
    made = [landscape(number, request.half) for number in range(len(kinds) * request.seeds)]
    return [
        Cell("landscapes", request.half, method, one.kind, one.dimension, number, budgets)
        for method in fast(request.methods)
        for number, one in enumerate(made)
    ]


def _measure_landscape(cell: Cell) -> dict[str, Any]:
    one = landscape(cell.number, "judging" if cell.half == "judging" else "setting")
    return reached(cell, one, {"": one.target}, FIRST_SEED[cell.half] + cell.number)


LANDSCAPES = Part(
    "landscapes",
    "Random landscapes",
    "Fraction of landscapes of each kind, one per seed, whose target was reached, at so many evaluations per parameter "
    "(tests/given/landscapes.py; 2 to 20 parameters).",
    _landscapes,
    _measure_landscape,
    table,
)


@cache
def closed_loop(name: str) -> Problem:
    """The problem of a campaign of the library."""
    return Problem(load_file(library()[name]))


@cache
def _dimension(name: str) -> int:
    return len(load_file(library()[name]).uncertain)


def known_margins() -> dict[str, float]:
    """The margin of the worst case of every campaign of the library, as its golden verdict states it.

    Campaigns with noise are left out: their verdicts also know realisations that a search does not evaluate.
    """
    verdicts = json.loads(VERDICTS.read_text(encoding="utf-8"))
    return {n: one["margin"] for n, one in verdicts.items() if one["margin"] is not None and not _noisy(n)}


@cache
def _noisy(name: str) -> bool:
    scenario = load_file(library()[name]).scenario
    return scenario is not None and len(scenario.realisations.seeds) > 1


def _loops(request: Request) -> list[Cell]:
    budgets = request.budgets or BUDGETS
    return [
        Cell("loops", request.half, method, name, _dimension(name), seed, budgets)
        for name in known_margins()
        for method in fast(request.methods)
        for seed in seeds(request)
    ]


def _measure_loop(cell: Cell, function: Function) -> dict[str, Any]:
    return reached(cell, function, _targets(cell.problem), cell.number)


def _loop(cell: Cell) -> Function:
    _targets(cell.problem)  # so that no search compiles the loop again
    return partial(costs, closed_loop(cell.problem))


@cache
def _targets(name: str) -> dict[str, float]:
    problem = closed_loop(name)
    worst = problem.threshold + known_margins()[name]
    nominal = float(costs(problem, problem.nominal_point[None, :])[0])
    fall = nominal - worst if np.isfinite(nominal) and nominal > worst else abs(worst)
    violated = {", violated": problem.threshold} if worst <= problem.threshold else {}
    return {"": worst + WITHIN * fall, **violated}


def costs(problem: Problem, points: Floats) -> Floats:
    """The deciding costs (m,), NaN where an evaluation failed or was excluded."""
    found, _ = problem.evaluate(points)
    return np.where(found.status == OK, found.costs[:, 0], np.nan)


LOOPS = Part(
    "loops",
    "Shipped closed loops",
    "Fraction of seeds that came within 1 % (of nominal less worst) of the worst case that the library's verdicts "
    "state, and, where that is a violation, that found any violation, at so many evaluations per parameter. Campaigns "
    "with noise are left out.",
    _loops,
    _measure_loop,
    table,
    shown="all",
    reach="loops",
    function=_loop,
)


def _falsification(request: Request) -> list[Cell]:
    budgets = request.budgets or SIMULATIONS
    return [
        Cell("falsification", request.half, method, name, problem.dimension, seed, budgets)
        for name, problem in PROBLEMS.items()
        for method in fast(request.methods)
        for seed in seeds(request)
    ]


def _measure_falsification(cell: Cell) -> dict[str, Any]:
    return reached(cell, PROBLEMS[cell.problem], {"": 0.0}, cell.number)


FALSIFICATION = Part(
    "falsification",
    "Falsification problems",
    "Fraction of seeds that found an input that violates the requirement, at so many evaluations per parameter "
    "(tests/given/falsification).",
    _falsification,
    _measure_falsification,
    table,
)
