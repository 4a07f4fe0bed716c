"""Whether the estimate of a lower case comes true: one search states it, another one of the same budget decides it.

Every landscape has two searches by `auto`, with seeds that nothing else uses; the halves never share one. Each of the
two states, and the other one decides. The points of `auto` do not depend on its budget, so that the beginning of a
search is a search of a smaller budget.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count, pairwise
from typing import Any, NamedTuple

import numpy as np

from campaigns.rules import SAME_COST
from tests.bench.scoreboard.bars import JUDGED, TRUE
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.contestants import Contestant
from tests.bench.scoreboard.parts import Part, Request, Table
from tests.bench.scoreboard.searches import Trace
from tests.given.landscapes import KINDS, Half, landscape
from worker.evidence.verdicts.sureness import as_low, chance, model

BUDGETS = (50, 100, 200, 500, 1000, 2000)
LARGEST = (200, 500, 200, 500, 1000, 500, 200, 500, 200, 500, 1000, 2000)
"""Evaluations per parameter; and the largest of the landscapes in turn, most of them small."""
EACH = 34
"""Landscapes for every seed that is asked for: 1,020 for 30."""
SLOW = (18, 5)
"""From so many parameters on, one landscape of so many is judged: models of so many take half a minute."""
SEEDS = {"setting": (70_001, 170_001), "judging": (1_300_001, 2_300_001)}
"""The first ones of the two searches."""
STATED = (0.0, 0.05, *TRUE, 0.3, 0.6, 1.0)
"""Statements between two of these are counted together."""


class Statement(NamedTuple):
    """What one search stated, and whether the other one was lower."""

    cell: Cell
    budget: int
    as_low: int
    chance: float
    lower: bool


def statements(rows: Sequence[Row]) -> list[Statement]:
    """All statements of measured cells."""
    return [Statement(row.cell, *made) for row in rows for made in row.figures.get("statements", ())]


def _cells(request: Request) -> list[Cell]:
    if JUDGED not in request.methods:
        return []
    found: list[Cell] = []
    for number in count():
        if len(found) == EACH * request.seeds:
            break
        one, turn = landscape(number, request.half), number // len(KINDS)
        if one.dimension >= SLOW[0] and turn % SLOW[1]:
            continue
        largest = LARGEST[turn % len(LARGEST)]
        budgets = request.budgets or tuple(budget for budget in BUDGETS if budget <= largest)
        found.append(Cell("sureness", request.half, JUDGED, one.kind, one.dimension, number, budgets))
    return found


def measure(cell: Cell) -> dict[str, Any]:
    """For each budget and each of the two searches, what it states and whether the other one was lower."""
    half: Half = "judging" if cell.half == "judging" else "setting"
    one, largest = landscape(cell.number, half), max(cell.budgets) * cell.dimension
    first, second = (Contestant(JUDGED).trace(one, cell.dimension, largest, s + cell.number) for s in SEEDS[cell.half])
    nominal = float(one(np.full((1, cell.dimension), 0.5))[0])
    made = [
        (budget, *statement)
        for budget in cell.budgets
        for pair in ((first, second), (second, first))
        if (statement := _statement(*pair, nominal, budget, cell.dimension)) is not None
    ]
    return {"statements": made}


def _statement(one: Trace, other: Trace, nominal: float, budget: int, n: int) -> tuple[int, float, bool] | None:
    """What a search states and on what, and whether the other one was lower by more than 1 % of nominal minus worst;
    None where no case is lower than the nominal one."""
    evaluations = budget * n
    lowest = one.lowest(evaluations)
    if not lowest < nominal:
        return None
    values = one.values[:evaluations]
    ranked = np.where(np.isnan(values), np.inf, values)
    lower = bool(other.lowest(evaluations) < lowest - SAME_COST.value * (nominal - lowest))
    return as_low(ranked, nominal), chance(ranked, nominal, model(n)), lower


def _table(rows: Sequence[Row]) -> Table:
    """Statements, their mean and the fraction that came true: by what was stated, by kind and by budget."""
    known = statements(rows)
    groups = {
        f"{100 * low:g} to {100 * high:g} %": [k for k in known if low <= k.chance < high]
        for low, high in pairwise(STATED)
    }
    groups |= {kind: [k for k in known if k.cell.problem == kind] for kind in KINDS}
    groups |= {f"{budget} n": [k for k in known if k.budget == budget] for budget in BUDGETS}
    return {f"{group}, {name}": {JUDGED: value} for group, of in groups.items() for name, value in _figures(of)}


def _figures(of: Sequence[Statement]) -> Iterator[tuple[str, float]]:
    yield "statements", float(len(of))
    if of:
        yield "stated", sum(one.chance for one in of) / len(of)
        yield "came true", sum(one.lower for one in of) / len(of)


PART = Part(
    "sureness",
    "How sure a search is",
    "The stated chance that another search of the same budget finds a case lower by more than 1 % of nominal minus "
    "worst, and the fraction of statements that came true: by what was stated, by kind and by budget, of two searches "
    "by `auto` on each of the random landscapes.",
    _cells,
    measure,
    _table,
    reach="runs",
)
