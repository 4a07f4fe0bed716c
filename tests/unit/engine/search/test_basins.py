"""Which minima are distinct, on functions whose basins are known: symmetric, shallow, at edges, behind failures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clearance.testing.searching import Function, batch
from tests.given.wells import wells
from worker.engine.search.base import Floats
from worker.engine.search.parts.basin import Basin, Rules
from worker.engine.search.parts.basins import distinct, downhill, promising, spread
from worker.engine.search.parts.polish import Polish

RULES = Rules(distance=0.03, barrier=0.05, at_most=8)


def evaluations(function: Function, points: Floats, rules: Rules = RULES) -> int:
    """How many distinct points are evaluated besides these candidates."""
    seen: set[bytes] = set()

    def counted(x: Floats) -> Floats:
        seen.update(p.tobytes() for p in x)
        return function(x)

    told_from(counted, points, rules)
    return len(seen - {p.tobytes() for p in points})


def told_from(function: Function, points: Floats, rules: Rules = RULES) -> list[Basin]:
    """The basins found from these candidates."""
    found: list[Basin] = []
    search = distinct(points, function(points), rules, found, Polish(lambda: 0, np.random.default_rng(0)))
    try:
        asked = next(search)
        while True:
            asked = search.send(batch(function(asked)))
    except StopIteration:
        return found


def told(function: Function, dimension: int, samples: int, rules: Rules = RULES, budget: int = 10**6) -> list[Basin]:
    """The basins found from a random sample, with at most so many evaluations."""
    points = np.random.default_rng(1).random((samples, dimension))
    values = function(points)
    rows = promising(points, np.where(np.isnan(values), np.inf, values), 24)
    found: list[Basin] = []
    search = distinct(points[rows], values[rows], rules, found, Polish(lambda: 0, np.random.default_rng(0)))
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


def test_a_candidate_on_the_slope_of_a_known_valley_needs_three_evaluations_at_most() -> None:
    """Lines to lower candidates replace descents, except where a ridge is seen."""
    function = wells((0.2, 0.2, 1), (0.8, 0.8, 0.9))
    slope = np.array([[0.2, 0.2], [0.25, 0.3], [0.35, 0.2], [0.2, 0.1], [0.3, 0.35]])
    alone, both = (evaluations(function, points) for points in (slope[:1], slope))
    assert both - alone <= 3 * (len(slope) - 1)
    apart = np.concatenate([slope, [[0.75, 0.7]]])
    assert len(told_from(function, apart)) == 2


def test_a_candidate_far_from_anything_lower_is_descended_from_whatever_its_line_shows() -> None:
    """Its line to the lowest has no rise above the barrier, yet its descent ends in a valley of its own."""
    low, own = np.array([0.1, 0.5]), np.array([0.7, 0.9])

    def function(x: Floats) -> Floats:
        return np.asarray(np.minimum(((x - low) ** 2).sum(axis=1), 0.27 + 0.5 * ((x - own) ** 2).sum(axis=1)))

    starts = np.array([low, [0.9, 0.65]])
    line = function(starts[1] + np.linspace(0, 1, 65)[:, None] * (starts[0] - starts[1]))
    assert (line - np.minimum.accumulate(line)).max() < 0.01
    assert len(told_from(function, starts, Rules(0.03, 0.01, 8))) == 1
    found = told_from(function, starts, Rules(0.03, 0.01, 8, alone=frozenset({1})))
    assert [tuple(np.round(b.point, 3)) for b in found] == [tuple(low), tuple(own)]


def test_descents_begin_from_candidates_that_are_alone_while_they_find_valleys_to_list() -> None:
    function = wells((0.2, 0.2, 1))
    far = np.random.default_rng(5).random((40, 2)) * [0.3, 0.3] + [0.05, 0.05]
    some = Rules(0.03, 0.05, 8, alone=frozenset(range(len(far))))
    assert evaluations(function, far, some) < 0.6 * evaluations(function, far, replace(some, followed=some.alone))


def test_starts_walk_down_what_is_stored() -> None:
    x = np.linspace(0.0, 1.0, 101)[:, None] * np.array([[1.0, 0.0]])
    values = np.abs(x[:, 0] - 0.4)
    basin = Basin(np.array([0.9, 0.0]), 0.5, [0])
    assert downhill(basin, x, values, 0.03) == np.inf
    assert basin.point.tolist() == [0.4, 0.0]
    high = Basin(np.array([0.9, 0.0]), 0.5, [0])
    assert downhill(high, x[:60], values[:60], 0.03) == pytest.approx(0.31)
    assert high.point.tolist() == [0.9, 0.0], "nothing lower is near"


def test_the_lowest_of_every_cell_is_a_candidate() -> None:
    points = np.random.default_rng(3).random((5000, 2))
    values = wells((0.2, 0.2, 1), (0.8, 0.8, 0.1))(points)
    values[7] = np.inf
    rows = spread(points, values, 0.25)
    cells = np.floor(points / 0.25)
    assert len(rows) == 16
    assert values[rows].tolist() == sorted(values[rows])
    for row in rows:
        assert values[row] == values[(cells == cells[row]).all(axis=1)].min()


def test_where_many_are_requested_a_quarter_are_low_though_something_lower_is_near() -> None:
    """Pairs of valleys: the second of each pair is near the first, and far lower than a plateau of far points."""
    pairs = np.array([[0.1, 0.5], [0.15, 0.5], [0.5, 0.5], [0.55, 0.5]])
    plateau = np.random.default_rng(4).random((40, 2)) * [1.0, 0.3]
    points = np.concatenate([pairs, plateau])
    ranked = np.concatenate([[0.0, 0.1, 0.05, 0.15], 1.0 + np.arange(40)])
    assert not {1, 3} <= set(promising(points, ranked, 16).tolist())
    assert {0, 1, 2, 3} <= set(promising(points, ranked, 16, 0.03).tolist())
