"""The test functions: every minimum against its minimisers, against random points and against polished ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from campaigns.results.base import EXCLUDED
from tests.given.at_night import nightly_but
from tests.given.functions_with_minima import BASIN, FUNCTIONS, OnUnitCube, on_unit_cube
from worker.engine.search.base import Floats

EACH = pytest.mark.parametrize("name", FUNCTIONS)
SHIFTS = pytest.mark.parametrize("seed", [None, 1, 2, 30])
DIMENSIONS = {
    "Branin": 2, "Goldstein-Price": 2, "six-hump camel": 2, "Shubert": 2, "Hartman 3": 3, "Hartman 6": 6,
    "Shekel 5": 4, "Shekel 7": 4, "Shekel 10": 4, "Rastrigin 5": 5, "Ackley 10": 10, "Griewank 5": 5, "Levy 8": 8,
    "narrow basin": 3, "excluded region": 3,
}  # fmt: skip


def below(f: OnUnitCube) -> float:
    """What counts as lower than the minimum: beyond rounding."""
    return f.minimum - 1e-9 * max(abs(f.minimum), 1.0)


def test_the_table_is_the_one_asked_for() -> None:
    assert {name: t.dimension for name, t in FUNCTIONS.items()} == DIMENSIONS
    for t in FUNCTIONS.values():
        assert t.low.shape == t.high.shape == (t.dimension,)
        assert (t.low < t.high).all()
        assert t.minimisers.shape[1] == t.dimension


@SHIFTS
@EACH
def test_the_minimum_is_taken_at_every_minimiser(name: str, seed: int | None) -> None:
    f = on_unit_cube(name, seed)
    assert len(f.minimisers) > 0
    assert f(f.minimisers) == pytest.approx(f.minimum, rel=1e-9, abs=1e-9)


@EACH
def test_minimisers_are_far_from_each_other_and_the_published_ones_are_all_there(name: str) -> None:
    points = on_unit_cube(name).minimisers
    apart = np.abs(points[:, None] - points[None]).max(axis=2) + np.eye(len(points))
    assert apart.min() > 0.01
    assert len(points) == {"Branin": 3, "six-hump camel": 2, "Shubert": 18}.get(name, 1)


@pytest.mark.by_day(5)
@pytest.mark.parametrize("seed", nightly_but((1,), [None, 1, 2]))
@EACH
def test_no_random_or_polished_point_is_lower(name: str, seed: int | None) -> None:
    f = on_unit_cube(name, seed)
    points = np.random.default_rng(7).random((20_000, f.dimension))
    values = f(points)
    assert np.nanmin(values) >= below(f)
    starts = np.concatenate([points[np.argsort(values)[:5]], f.minimisers[:2] + 1e-3, f.minimisers[:2]])
    for start in np.clip(starts, 0.0, 1.0):
        found = minimize(
            lambda x: _value(f, x), start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * f.dimension,
            options={"maxfev": 400, "fatol": 1e-12, "xatol": 1e-12},
        )  # fmt: skip
        assert found.fun >= below(f)


def _value(f: OnUnitCube, x: Floats) -> float:
    value = float(f(x[None, :])[0])
    return value if np.isfinite(value) else 1e9


@EACH
def test_the_shift_moves_the_optimum_off_the_centre_and_keeps_it_inside(name: str) -> None:
    still = on_unit_cube(name).minimisers[0]
    seen = set()
    for seed in range(30):
        first = on_unit_cube(name, seed).minimisers[0]
        assert (np.abs(first - still) > 0.009).all()
        assert (np.abs(first - still) < 0.2501).all()
        assert first.min() > 0.0499
        assert first.max() < 0.9501
        seen.add(first.tobytes())
    assert len(seen) == 30
    assert np.array_equal(on_unit_cube(name, 3).shift, on_unit_cube(name, 3).shift)


def test_gaps_are_fractions_of_the_minimum_or_the_difference_where_it_is_zero() -> None:
    assert FUNCTIONS["Shubert"].gap(-186.7309088310239 * 0.99) == pytest.approx(0.01)
    assert FUNCTIONS["Rastrigin 5"].gap(0.25) == 0.25
    assert on_unit_cube("narrow basin").gap(-0.5) == 0.5


def test_the_narrow_basin_is_narrow_deep_and_cut_by_steps() -> None:
    f = on_unit_cube("narrow basin")
    points = np.random.default_rng(1).random((200_000, 3))
    assert 0.0003 < (f(points) < 1.0).mean() < 0.0007
    along = BASIN + np.linspace(0.0, 0.05, 5001)[:, None] * [1.0, 0.0, 0.0]
    jumps = np.abs(np.diff(f(along)))
    assert np.count_nonzero(jumps > 0.04) == 4


def test_the_excluded_region_is_low_at_its_edge_but_not_lowest() -> None:
    f = on_unit_cube("excluded region")
    assert f.status == EXCLUDED
    points = np.random.default_rng(1).random((200_000, 3))
    values = f(points)
    assert 0.05 < np.isnan(values).mean() < 0.07
    edge = np.abs(np.linalg.norm(points - [0.7, 0.6, 0.5], axis=1) - 0.255) < 0.005
    assert -0.7 < np.nanmin(values[edge]) < np.nanmax(values[edge]) < -0.69
    lower = values < -0.71
    assert 0.001 < lower.mean() < 0.01
