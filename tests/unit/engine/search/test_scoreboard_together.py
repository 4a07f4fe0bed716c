"""Searches of the score board side by side: each has what it would have alone."""

from __future__ import annotations

import os
import signal
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from clearance.testing.searching import Function
from tests.bench.scoreboard import cells
from tests.bench.scoreboard.cells import Cell
from tests.bench.scoreboard.reaching import reached
from tests.bench.scoreboard.together import together
from tests.faults.processes import until
from worker.engine.search.base import Floats


def bowl(points: Floats) -> Floats:
    """Where the first parameter is below 0.1 it has no value."""
    return np.where(points[:, 0] < 0.1, np.nan, ((points - 0.3) ** 2).sum(axis=1))


def measure(cell: Cell, function: Function) -> dict[str, Any]:
    return reached(cell, function, {"": 1e-4}, cell.number)


METHODS = ("auto", "nlopt_global", "monte_carlo", "pycma_bipop", "nlopt_crs")


@pytest.mark.nightly
@pytest.mark.parametrize("processes", [1, pytest.param(2, marks=pytest.mark.nightly)])
def test_the_figures_of_a_cell_are_those_that_it_has_alone(processes: int, tmp_path: Path) -> None:
    asked = [Cell("p", "setting", m, "bowl", 2, seed, (10, 30)) for seed in (1, 2, 3) for m in METHODS]
    versions = dict.fromkeys(METHODS, "one")
    rows = cells.measured(asked, measure, tmp_path / "cells.jsonl", processes, versions, function=bowl_of)
    assert [row.cell for row in rows] == asked
    for row in rows:
        alone = measure(row.cell, bowl)
        assert (row.figures, row.error) == ({k: v for k, v in alone.items() if k != "error"}, alone["error"])


def bowl_of(cell: Cell) -> Function:
    return bowl


def test_points_of_all_that_search_are_evaluated_together() -> None:
    sizes: list[int] = []

    def counted(points: Floats) -> Floats:
        sizes.append(len(points))
        return points.sum(axis=1)

    def search(length: int) -> Any:
        return lambda function: [function(np.full((length, 2), value)).tolist() for value in (1.0, 2.0, 3.0)][:length]

    found = together([search(1), search(2), search(3)], counted)
    assert found == [[[2.0]], [[2.0] * 2, [4.0] * 2], [[2.0] * 3, [4.0] * 3, [6.0] * 3]]
    assert sizes == [6, 6, 6]


def test_what_fails_ends_its_own_search_only() -> None:
    def fails(function: Function) -> float:
        function(np.zeros((1, 2)))
        raise ValueError("no value")

    def dies(function: Function) -> float:
        function(np.zeros((1, 2)))
        os.kill(os.getpid(), signal.SIGKILL)
        return 0.0

    def goes_on(function: Function) -> float:
        return sum(float(function(np.ones((1, 2)))[0]) for _ in range(5))

    first, second, third = together([fails, dies, goes_on], lambda points: points.sum(axis=1))
    assert isinstance(first, ValueError)
    assert isinstance(second, RuntimeError)
    assert third == 10.0


def test_no_search_outlives_what_it_searches_for(tmp_path: Path) -> None:
    def search(function: Function) -> None:
        (tmp_path / str(os.getpid())).touch()
        function(np.zeros((1, 2)))

    def broken(points: Floats) -> Floats:
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        together([search] * 3, broken)
    begun = {int(file.name) for file in tmp_path.iterdir()}
    assert len(begun) == 3
    until(lambda: not begun & {child.pid for child in active_children()}, "they end")


def test_a_function_that_raises_is_the_error_of_every_cell(tmp_path: Path) -> None:
    def none(cell: Cell) -> Function:
        def broken(points: Floats) -> Floats:
            raise ValueError("broken")

        return broken

    asked = [Cell("p", "setting", "direct", "bowl", 2, seed, (5,)) for seed in (1, 2)]
    rows = cells.measured(asked, measure, tmp_path / "cells.jsonl", 1, {"direct": "one"}, function=none)
    assert [(row.figures, row.error) for row in rows] == [({}, "ValueError: broken")] * 2
