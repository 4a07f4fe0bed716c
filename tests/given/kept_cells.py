"""The cells of the score board that are kept with the code."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from tests.bench.scoreboard import __main__ as board
from tests.bench.scoreboard import cells
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.contestants import names
from tests.bench.scoreboard.parts import Part, Request


def kept_rows(part: Part) -> list[Row]:
    """The cells of a part of the whole board, without figures where they are not kept."""
    known = _known(part.name)
    return [
        known.get(cell, Row(cell, {}, "", 0.0)) for cell in part.cells(Request("judging", tuple(names()), board.SEEDS))
    ]


@cache
def _known(part: str) -> Mapping[Cell, Row]:
    return cells.stored(cells.lines(cells.kept(part, cells.KEPT)))
