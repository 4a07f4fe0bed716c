"""Whether the estimate of a lower case comes true: a search states it, another one of the same budget decides it.

Every landscape has two searches by `auto`, whose seeds nothing else uses; the halves never share one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from campaigns.rules import SAME_COST
from tests.bench.scoreboard.bars import JUDGED
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.contestants import Contestant
from tests.bench.scoreboard.parts import Part, Request, Table
from tests.given.landscapes import KINDS, landscape
from worker.evidence.verdicts.sureness import chance

BUDGETS = (50, 100, 200, 500, 1000, 100, 200, 500, 50, 100, 200, 2000)
"""Evaluations per parameter; a landscape has one of them, the small ones more often."""
EACH = 4
"""Landscapes of each kind for every seed that is asked for: 1,200 for 30."""
SEEDS = {"setting": (70_001, 170_001), "judging": (1_300_001, 2_300_001)}
"""The first ones of the search that states and of the one that decides."""
STATED = ((0.0, 0.02), (0.02, 0.05), (0.05, 0.15), (0.15, 0.3), (0.3, 1.0))
"""Statements that are counted together; those between 5 and 15 % are the ones at about 10 %."""


def _cells(request: Request) -> list[Cell]:
    if JUDGED not in request.methods:
        return []
    budgets, found = request.budgets or BUDGETS, []
    for number in range(EACH * request.seeds * len(KINDS)):
        one = landscape(number, request.half)
        budget = budgets[number // len(KINDS) % len(budgets)]
        found.append(Cell("sureness", request.half, JUDGED, one.kind, one.dimension, number, (budget,)))
    return found


def measure(cell: Cell) -> dict[str, Any]:
    """The stated chance, and whether the other search found a case lower by more than 1 % of nominal minus worst; no
    chance where no case is lower than the nominal one, or that failed."""
    one = landscape(cell.number, "judging" if cell.half == "judging" else "setting")
    budget = cell.budgets[0] * cell.dimension
    first, other = (
        Contestant(JUDGED).trace(one, cell.dimension, budget, seed + cell.number) for seed in SEEDS[cell.half]
    )
    nominal = float(one(np.full((1, cell.dimension), 0.5))[0])
    lowest, found = first.lowest(budget), other.lowest(budget)
    if not lowest < nominal:
        return {"chance": None, "lower": False}
    ranked = np.where(np.isnan(first.values), np.inf, first.values)
    return {
        "chance": chance(first.points, ranked, nominal),
        "lower": bool(found < lowest - SAME_COST.value * (nominal - lowest)),
    }


def _table(rows: Sequence[Row]) -> Table:
    """Statements, their mean and the fraction that came true, by what was stated and by kind."""
    stated = [(row.cell.problem, row.figures["chance"], row.figures["lower"]) for row in rows if row.figures]
    known = [(kind, float(chance), bool(lower)) for kind, chance, lower in stated if chance is not None]
    groups = {f"{100 * low:g} to {100 * high:g} %": [k for k in known if low <= k[1] < high] for low, high in STATED}
    groups |= {kind: [k for k in known if k[0] == kind] for kind in KINDS}
    return {f"{group}, {name}": {JUDGED: value} for group, of in groups.items() for name, value in _figures(of)}


def _figures(of: Sequence[tuple[str, float, bool]]) -> Iterator[tuple[str, float]]:
    yield "statements", float(len(of))
    if of:
        yield "stated", sum(chance for _, chance, _ in of) / len(of)
        yield "came true", sum(lower for _, _, lower in of) / len(of)


PART = Part(
    "sureness",
    "How sure a search is",
    "Of searches by `auto` on random landscapes, each at 50 to 2,000 evaluations per parameter: the stated "
    " chance that another search of the same budget finds a case lower by more than 1 % of nominal minus worst, "
    "and the fraction of statements that came true.",
    _cells,
    measure,
    _table,
    runs=True,
)
