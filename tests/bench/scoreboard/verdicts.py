"""What a user gets who chooses nothing: the verdict of `clearance.search` where a violation is known to exist.

Each of these problems has a violation, so that "cleared" is false. The seed of the search is the cell's; that of the
independent sample is drawn, as at any launch, because nothing is cleared with one that was stated.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import clearance
from clearance.testing.searching import Function
from tests.bench.scoreboard.bars import JUDGED
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.parts import Part, Request, Table, averaged
from tests.bench.scoreboard.reaching import closed_loop, costs, seeds
from tests.given.falsification import PROBLEMS
from worker.engine.search.base import Floats

PORTED = ("CC1", "CC2", "CC3", "CC5", "AT1", "AT2", "AT6a", "AT6b", "AT6c", "F16")
"""Of the falsification problems, those for which an input that violates the requirement is known."""
SHIPPED = ("uav_aca_latency", "uav_aca_right_of_way", "uav_static_wind", "pioneer_latency", "unicycle_navigation")
"""Of the library, some whose verdict is a violation that is not the nominal case."""


def _cells(request: Request) -> list[Cell]:
    found = {name: PROBLEMS[name].dimension for name in PORTED} | {n: closed_loop(n).dimension for n in SHIPPED}
    made = [Cell("verdicts", request.half, JUDGED, n, d, seed) for n, d in found.items() for seed in seeds(request)]
    return made if JUDGED in request.methods else []


def measure(cell: Cell, budget: int | None = None) -> dict[str, Any]:
    """The verdict, and whether it is a violation and not cleared."""
    function, threshold = _problem(cell.problem)
    names = [f"x{i}" for i in range(cell.dimension)]

    def fly(**values: Floats) -> Floats:
        return function(np.stack([np.asarray(values[name]) for name in names], axis=1))

    result = clearance.search(
        fly, dict.fromkeys(names, (0.0, 1.0)), threshold, vectorized=True, seed=cell.number, budget=budget
    )
    return {
        "verdict": str(result.verdict),
        "found": str(result.verdict) == "violated",
        "not cleared": str(result.verdict) != "cleared",
        "evaluations": len(result.costs),
    }


def _problem(name: str) -> tuple[Function, float]:
    if name in PROBLEMS:
        return PROBLEMS[name], 0.0
    problem = closed_loop(name)
    return (lambda points: costs(problem, points)), problem.threshold


def _table(rows: Sequence[Row]) -> Table:
    def figures(row: Row) -> dict[str, float]:
        own = {f"{row.cell.problem}, {name}": float(row.figures[name]) for name in ("found", "not cleared")}
        return {f"all, {name}": float(row.figures[name]) for name in ("found", "not cleared")} | own

    return averaged(rows, figures)


PART = Part(
    "verdicts",
    "Verdicts without a choice",
    "Fraction of seeds in which `clearance.search` with nothing chosen states a violation, and in which it does not "
    'state "cleared", on problems that have a violation.',
    _cells,
    measure,
    _table,
    reach="runs",
)
