"""The trend of costs over the box: where they are below it, and where nothing can be said."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.testing.searching import Function, batch
from worker.engine.search.base import Floats
from worker.engine.search.parts.trend import AROUND, KEPT, POINTS, Trend

N = 3
DENT = np.array([0.85, 0.2, 0.7])


def bowl(x: Floats) -> Floats:
    """A quadratic, which is its own trend."""
    return np.asarray(((x - 0.4) ** 2).sum(axis=1) + x[:, 0] * x[:, 1])


def dented(x: Floats) -> Floats:
    """Lower around a point that is nowhere near low."""
    return np.asarray(bowl(x) - 0.05 * np.maximum(1.0 - np.abs(x - DENT).max(axis=1) / 0.1, 0.0))


def seen(function: Function, count: int = 800, dimension: int = N) -> Trend:
    trend = Trend(dimension)
    points = np.random.default_rng(1).random((count, dimension))
    trend.see(points, function(points))
    return trend


def closer(trend: Trend, function: Function, seed: int = 1) -> tuple[Floats | None, list[int]]:
    """Where the search for lower residuals ends, and how many points it requested each time."""
    search, requested = trend.closer(np.random.default_rng(seed)), []
    try:
        points = next(search)
        while True:
            assert points.min() >= 0.0
            assert points.max() <= 1.0
            requested.append(len(points))
            points = search.send(batch(function(points)))
    except StopIteration as end:
        return end.value, requested


@pytest.mark.parametrize("seed", range(10))
def test_it_ends_where_the_cost_is_farthest_below_the_trend(seed: int) -> None:
    point, requested = closer(seen(dented), dented, seed)
    assert point is not None
    assert np.abs(point - DENT).max() < 0.05
    assert requested == [POINTS * N] * len(AROUND)


def test_a_cost_that_is_its_own_trend_is_below_it_nowhere() -> None:
    assert closer(seen(bowl), bowl) == (None, [])


def test_too_few_points_have_no_trend() -> None:
    assert closer(seen(dented, 15), dented) == (None, [])
    assert closer(Trend(N), dented) == (None, [])


@pytest.mark.nightly
def test_it_looks_at_no_place_twice_until_none_is_left() -> None:
    trend, ends = seen(dented), []
    while (point := closer(trend, dented)[0]) is not None:
        ends.append(point)
        assert len(ends) <= KEPT
    assert 1 < len(trend._seen) == len(ends)
    apart = np.abs(trend._seen[:, None] - trend._seen[None]).max(axis=2)
    assert apart[np.triu_indices(len(ends), 1)].min() >= 0.05


def test_a_cell_keeps_its_first_point_and_failed_ones_count_nowhere() -> None:
    trend = Trend(2)
    trend.see(np.array([[0.31, 0.5], [0.32, 0.51], [0.7, 0.7], [1.0, 1.0]]), np.array([3.0, 1.0, np.inf, 2.0]))
    assert trend._values[: len(trend._filled)].tolist() == [3.0, 2.0]


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e100])
def test_where_it_looks_depends_on_no_scale(scale: float) -> None:
    def scaled(x: Floats) -> Floats:
        return scale * dented(x)

    point, _ = closer(seen(scaled), scaled)
    assert point is not None
    assert np.abs(point - DENT).max() < 0.05


def test_costs_too_large_to_be_squared_have_no_trend() -> None:
    def large(x: Floats) -> Floats:
        return 1e300 * dented(x)

    assert closer(seen(large), large) == (None, [])


def test_where_every_closer_look_fails_the_place_itself_is_left() -> None:
    def failing(x: Floats) -> Floats:
        return np.full(len(x), np.nan)

    trend = seen(dented)
    point, requested = closer(trend, failing)
    assert np.array_equal(point, trend._seen[0])
    assert len(requested) == len(AROUND)
