"""Which minima are distinct, on functions whose basins are known: symmetric, shallow, at edges, behind failures."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.testing.searching import Function, batch
from worker.engine.search.base import Floats
from worker.engine.search.parts.basins import Basin, Rules, distinct, promising

RULES = Rules(distance=0.03, barrier=0.05, at_most=8)


def wells(*places: tuple[float, float, float]) -> Function:
    """Gaussian wells in the plane: x, y, depth."""

    def value(x: Floats) -> Floats:
        found = np.zeros(len(x))
        for a, b, depth in places:
            found -= depth * np.exp(-((x - [a, b]) ** 2).sum(axis=1) / 0.02)
        return found

    return value


def told(function: Function, dimension: int, samples: int, rules: Rules = RULES, budget: int = 10**6) -> list[Basin]:
    """The basins found from a random sample, with at most so many evaluations."""
    points = np.random.default_rng(1).random((samples, dimension))
    values = function(points)
    rows = promising(points, np.where(np.isnan(values), np.inf, values), 24)
    found: list[Basin] = []
    search = distinct(points[rows], values[rows], rules, found)
    try:
        asked = next(search)
        while budget >= len(asked):
            budget -= len(asked)
            asked = search.send(batch(function(asked)))
    except StopIteration:
        pass
    search.close()
    return found


def test_two_symmetric_wells_are_two() -> None:
    found = told(wells((0.2, 0.2, 1), (0.8, 0.8, 1)), 2, 2000)
    assert len(found) == 2
    assert sorted(tuple(np.round(b.point, 5)) for b in found) == [(0.2, 0.2), (0.8, 0.8)]
    assert found[0].cost == pytest.approx(found[1].cost, abs=1e-12)


def test_a_shallow_well_next_to_two_deep_ones_is_the_third() -> None:
    found = told(wells((0.2, 0.2, 1), (0.8, 0.8, 1), (0.8, 0.2, 0.3)), 2, 2000)
    assert [round(b.cost, 2) for b in found] == [-1.0, -1.0, -0.3]


def test_the_deepest_are_retained_where_fewer_are_requested() -> None:
    found = told(wells((0.2, 0.2, 1), (0.8, 0.8, 0.9), (0.8, 0.2, 0.3)), 2, 2000, Rules(0.03, 0.05, 2))
    assert [round(b.cost, 2) for b in found] == [-1.0, -0.9]


def test_ripples_below_the_barrier_are_one_basin() -> None:
    def rippled(x: Floats) -> Floats:
        return np.asarray(((x - 0.4) ** 2).sum(axis=1) + 0.01 * np.cos(60 * x).prod(axis=1))

    assert len(told(rippled, 2, 2000)) == 1
    assert len(told(rippled, 2, 2000, Rules(0.03, 1e-4, 8))) > 1


def test_a_curved_valley_is_one_when_its_ends_are_close_in_cost() -> None:
    (only,) = told(lambda x: np.asarray((x[:, 0] - x[:, 1] ** 2) ** 2), 2, 1000)
    assert only.cost == pytest.approx(0.0, abs=1e-12)


def test_minima_at_corners_are_met_exactly() -> None:
    found = told(lambda x: -np.abs(x - 0.5).sum(axis=1), 2, 500, Rules(0.03, 0.05, 8))
    assert sorted(tuple(b.point) for b in found) == [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
    assert {b.cost for b in found} == {-1.0}


def test_a_kink_is_polished_to_its_tip() -> None:
    (only,) = told(lambda x: np.abs(x - 0.371).max(axis=1), 3, 500)
    assert np.abs(only.point - 0.371).max() < 1e-6


def test_what_fails_between_two_minima_is_a_barrier() -> None:
    def split(x: Floats) -> Floats:
        return np.where(np.abs(x[:, 0] - 0.5) < 0.15, np.nan, ((x - 0.5) ** 2).sum(axis=1))

    found = told(split, 2, 2000)
    assert len(found) == 2
    assert sorted(round(float(b.point[0]), 3) for b in found) == [0.35, 0.65]


def test_members_name_the_candidates_that_ended_there() -> None:
    found = told(wells((0.2, 0.2, 1), (0.8, 0.8, 1)), 2, 2000)
    members = [i for b in found for i in b.members]
    assert len(members) == len(set(members)) == 24


def test_what_was_known_when_the_budget_ended_is_not_lost() -> None:
    function = wells((0.2, 0.2, 1), (0.8, 0.8, 0.9))
    for budget in (0, 10, 100, 500):
        found = told(function, 2, 2000, budget=budget)
        assert found
        assert min(b.cost for b in found) <= function(np.random.default_rng(1).random((2000, 2))).min()
        assert [b.cost for b in found] == sorted(b.cost for b in found)


def test_promising_points_are_low_and_apart() -> None:
    points = np.random.default_rng(2).random((3000, 2))
    values = wells((0.2, 0.2, 1), (0.8, 0.8, 0.4))(points)
    rows = promising(points, values, 6)
    assert rows[0] == np.argmin(values)
    assert len(set(rows.tolist())) == len(rows) == 6
    assert (np.abs(points[rows] - 0.8).max(axis=1) < 0.1).any()


def test_points_without_a_cost_are_not_promising() -> None:
    points = np.random.default_rng(2).random((50, 2))
    ranked = np.full(50, np.inf)
    assert len(promising(points, ranked, 6)) == 0
    ranked[7] = 1.0
    assert promising(points, ranked, 6).tolist() == [7]
