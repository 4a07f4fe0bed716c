"""The parts of the score board: their cells, how a cell is measured, and the table of their rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from tests.bench.scoreboard.cells import Cell, Measure, Reach, Row, Searched
from tests.given.landscapes import Half

Table = dict[str, dict[str, float]]
"""Figures by column and method."""


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

    cells: those of a request. table: figures by column and method, a column being `GROUP @ BUDGET` or `GROUP`.
    shown: what columns of the page begin with; the file has all. reach: what its cells are valid for. function: what
    is searched, where the searches with all seeds go side by side.
    """

    name: str
    title: str
    text: str
    cells: Callable[[Request], list[Cell]]
    measure: Measure
    table: Callable[[Sequence[Row]], Table]
    shown: str = ""
    reach: Reach = "method"
    function: Searched | None = None


def averaged(rows: Sequence[Row], figures: Callable[[Row], Mapping[str, float | None]]) -> Table:
    """The mean of each figure by column and method.

    A method has no figure in a column in which one of its rows failed, is missing or has none: the mean of the rest
    would flatter it. Such a row counts in the columns that others have of its problem.
    """
    made = [(row, figures(row) if row.figures else None) for row in rows]
    columns: dict[tuple[str, int], dict[str, None]] = {}
    for row, of in made:
        columns.setdefault(row.cell[3:5], {}).update(dict.fromkeys(of or ()))
    found: dict[str, dict[str, list[float | None]]] = {}
    for row, of in made:
        for column, value in (dict.fromkeys(columns[row.cell[3:5]]) if of is None else of).items():
            found.setdefault(column, {}).setdefault(row.cell.method, []).append(value)
    return {
        column: {method: mean for method, values in by.items() if (mean := _mean(values)) is not None}
        for column, by in found.items()
    }


def _mean(values: Sequence[float | None]) -> float | None:
    stated = [float(value) for value in values if value is not None]
    return sum(stated) / len(stated) if len(stated) == len(values) else None
