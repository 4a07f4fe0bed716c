"""MLSL: visits every valley, does not stop by itself, handles points without a value, works with batches of one."""

from __future__ import annotations

from typing import get_args, get_type_hints

import numpy as np
import pytest

from clearance.testing.searching import run
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods.mlsl import Options, method

LOCALS = get_args(get_type_hints(Options)["local"])


def four_valleys(x: Floats) -> Floats:
    return np.asarray(np.cos(4 * np.pi * x).sum(axis=1) + x @ [0.2, 0.1])


@pytest.mark.parametrize("local", LOCALS)
def test_every_valley_is_visited(local: str) -> None:
    found = run(method, four_valleys, 2, 2500, options={"local": local})
    assert found.text is None
    assert {len(b) for b in found.batches} == {1}
    for bottom in ([0.25, 0.25], [0.25, 0.75], [0.75, 0.25], [0.75, 0.75]):
        assert np.abs(found.points - bottom).max(axis=1).min() < 0.01
    (minimum,) = found.minima
    assert minimum.cost == found.lowest


@pytest.mark.parametrize("local", LOCALS)
def test_points_without_a_value_do_not_end_it(local: str) -> None:
    found = run(method, lambda x: np.where(x[:, 0] > 0.6, np.nan, four_valleys(x)), 2, 1000, options={"local": local})
    assert found.lowest < -1.8
    assert run(method, lambda x: np.full(len(x), np.nan), 2, 200, options={"local": local}).minima == []


@pytest.mark.parametrize("name", ["Branin", "Hartman 3", "Shekel 7"])
def test_the_known_minimum_is_found(name: str) -> None:
    function = on_unit_cube(name, 1)
    assert function.gap(run(method, function, function.dimension, 5000).lowest) < 0.01


def test_its_points_do_not_depend_on_the_budget() -> None:
    short, long = run(method, four_valleys, 2, 300), run(method, four_valleys, 2, 600)
    assert np.array_equal(short.points, long.points[:300])
