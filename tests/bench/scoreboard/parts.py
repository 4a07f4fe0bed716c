"""The parts of the score board: their cells, how a cell is measured, and the table of their rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tests.bench.scoreboard.cells import Cell, Measure, Row
from tests.given.landscapes import Half


@dataclass(frozen=True)
class Request:
    """What is to be measured: the half, the methods, the seeds, and budgets in evaluations per parameter; None: the
    part's own."""

    half: Half
    methods: tuple[str, ...]
    seeds: int
    budgets: tuple[int, ...] | None = None


@dataclass(frozen=True)
class Part:
    """One part: its name and title, what its figures are, and how they are made.

    cells: those of a request. table: figures by column and method, a column being `GROUP @ BUDGET` or a single word.
    """

    name: str
    title: str
    text: str
    cells: Callable[[Request], list[Cell]]
    measure: Measure
    table: Callable[[Sequence[Row]], dict[str, dict[str, float]]]


def averaged(rows: Sequence[Row], figures: Callable[[Row], dict[str, Any]]) -> dict[str, dict[str, float]]:
    """The mean of each figure by column and method, where every row of the method that has the column has it.

    A row that failed altogether leaves its method without any figure: an average over the rest would flatter it.
    """
    found: dict[str, dict[str, list[float]]] = {}
    failed = {row.cell.method for row in rows if not row.figures}
    for row in rows:
        for column, value in (figures(row) if row.cell.method not in failed else {}).items():
            found.setdefault(column, {}).setdefault(row.cell.method, []).append(float(value))
    return {c: {m: sum(values) / len(values) for m, values in by.items()} for c, by in found.items()}
