"""Where a search with restarts begins its descents, and when a descent has stopped improving."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np
import pytest

from clearance.testing.searching import Function, batch, space
from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.explored import BESIDE, NEAR, NEAREST, Explored
from worker.engine.search.parts.progress import Progress


def grown(explored: Explored, count: int, values: Floats) -> Floats:
    """The sample's next points, which get these values."""
    asked = explored.grow(count)
    points = next(asked)
    with pytest.raises(StopIteration):
        asked.send(batch(values))
    return points


def test_the_sample_fills_the_box_and_continues_where_it_stopped() -> None:
    whole, parts = Explored(space(3, 100)), Explored(space(3, 100))
    points = grown(whole, 8, np.arange(8.0))
    assert np.array_equal(points, np.concatenate([grown(parts, 3, np.arange(3.0)), grown(parts, 5, np.arange(5.0))]))
    assert (np.sort((points * 8).astype(int), axis=0) == np.arange(8)[:, None]).all(), "one point in every eighth"


def evaluated(search: Generator[Floats, Batch, None], f: Function) -> list[Floats]:
    """The requests of a part of a search, whose points get the values of a function."""
    asked, answer = [], None
    while True:
        try:
            asked.append(search.send(answer))  # type: ignore[arg-type]
        except StopIteration:
            return asked
        answer = batch(f(asked[-1]))


def apart(x: Floats) -> Floats:
    """Every parameter acts alone, with a valley at 1/6 and a deeper one at 0.8."""
    return np.asarray(np.minimum((x - 1 / 6) ** 2, (x - 0.8) ** 2 - 0.02).sum(axis=1))


def test_it_begins_with_a_star_around_the_centre_and_joins_the_better_values() -> None:
    explored = Explored(space(3, 100))
    star, joined = evaluated(explored.begin(), lambda x: ((x - [1, 0, 0.5]) ** 2).sum(axis=1))
    assert star[0].tolist() == [0.5] * 3
    moved = star[1:] != 0.5
    assert moved.sum(axis=1).tolist() == [1] * 6
    assert np.sort(star[1:][moved]).tolist() == pytest.approx([1 / 6] * 3 + [5 / 6] * 3)
    assert joined.tolist() == [pytest.approx([5 / 6, 1 / 6, 0.5])]
    assert len(explored.sample) == len(explored.points) == 8


@pytest.mark.parametrize("middle", [0.5, 0.02, 1.0, 0.9])
def test_a_further_star_has_a_value_in_either_half_of_what_is_not_near(middle: float) -> None:
    low, high = max(middle - BESIDE, 0.0), min(middle + BESIDE, 1.0)
    length = low + 1.0 - high
    for seed in range(20):
        explored = Explored(space(2, 100, seed=seed))
        explored.add(np.array([[0.3, 0.3], [middle, middle]]), np.array([2.0, 1.0]))
        (star,) = evaluated(explored.star(), lambda x: np.full(len(x), 3.0))
        assert (star != middle).sum(axis=1).tolist() == [1] * 4
        for axis in (0, 1):
            pair = star[2 * axis : 2 * axis + 2, axis]
            assert ((pair >= 0) & (pair <= 1) & ((pair <= low) | (pair >= high))).all()
            inside = np.where(pair <= low, pair, pair - (high - low)) / length
            assert inside[0] <= 0.5 <= inside[1]


def test_stars_find_the_best_valley_where_parameters_act_alone() -> None:
    explored = Explored(space(8, 1000))
    evaluated(explored.begin(), apart)
    for _ in range(4):
        evaluated(explored.star(), apart)
    best = explored.points[np.argmin(explored.values)]
    assert (np.abs(best - 0.8) < 0.15).all(), "in 85 evaluations in one of 256 valleys"


def test_a_point_is_joined_only_where_several_axes_have_a_better_value() -> None:
    explored = Explored(space(3, 100))
    assert len(evaluated(explored.begin(), lambda x: ((x - [1, 0.5, 0.5]) ** 2).sum(axis=1))) == 1
    assert len(evaluated(explored.star(), lambda x: np.full(len(x), 9.0))) == 1


@pytest.mark.parametrize("at_once", [1, 4, 16])
def test_requests_are_multiples_of_the_slots_filled_with_the_sample(at_once: int) -> None:
    explored = Explored(space(3, 100), at_once)
    asked = evaluated(explored.begin(), apart) + evaluated(explored.star(), apart) + evaluated(explored.grow(5), apart)
    assert {len(points) % at_once for points in asked} == {0}
    assert np.array_equal(np.concatenate(asked), explored.sample)


def test_a_star_whose_middle_or_arms_fail_continues_with_what_has_a_value() -> None:
    def fails(x: Floats) -> Floats:
        return np.where(np.abs(x - 0.5).max(axis=1) < 0.1, np.nan, x[:, 0] + x[:, 1])

    explored = Explored(space(2, 100))
    _, joined = evaluated(explored.begin(), fails)
    assert joined[0].tolist() == pytest.approx([1 / 6, 1 / 6]), "the middle has no value: any is better"
    nothing = Explored(space(2, 100))
    assert len(evaluated(nothing.begin(), lambda x: np.full(len(x), np.nan))) == 1
    assert len(evaluated(nothing.star(), lambda x: np.full(len(x), np.nan))) == 1
    assert nothing.start() is None


def test_a_descent_begins_at_the_lowest_point_that_is_not_near_to_another() -> None:
    explored = Explored(space(2, 100))
    values = np.array([5.0, 1.0, np.nan, 3.0, 2.0, 4.0, 6.0, 7.0])
    points = grown(explored, 8, values)
    begun = []
    while (start := explored.start()) is not None:
        begun.append(start)
        explored.visit(start)
    near = min(NEAR * explored.spacing(), NEAREST)
    chosen = [int(np.flatnonzero((points == b).all(axis=1))[0]) for b in begun]
    assert chosen[0] == 1
    assert values[chosen].tolist() == sorted(values[chosen])
    assert 2 not in chosen, "it has no value"
    for i in set(range(8)) - {2}:
        lower = points[[k for k in range(8) if k in chosen or values[k] < values[i]]]
        assert i in chosen or np.linalg.norm(lower - points[i], axis=1).min() <= near
    apart = [np.linalg.norm(a - b) for k, a in enumerate(begun) for b in begun[:k]]
    assert min(apart) > near


def test_a_descent_does_not_begin_near_to_a_lower_evaluation() -> None:
    explored = Explored(space(2, 100))
    points = grown(explored, 4, np.array([1.0, 2.0, 3.0, 4.0]))
    explored.visit(points[0])
    explored.add(points[1:3] + 1e-3, np.array([1.9, 3.1]))
    chosen = explored.start()
    assert chosen is not None
    assert np.array_equal(chosen, points[2]), (
        "the evaluation next to it is higher, that next to the one before is lower"
    )


def test_where_nothing_has_a_value_no_descent_begins_until_the_sample_has_one() -> None:
    explored = Explored(space(2, 100))
    grown(explored, 4, np.full(4, np.nan))
    assert explored.start() is None
    assert (explored.lowest, explored.spread) == (math.inf, 0.0)
    points = grown(explored, 2, np.array([np.nan, 7.0]))
    assert np.array_equal(explored.start(), points[1])


@pytest.mark.parametrize(("dimension", "count"), [(1, 50), (2, 200), (5, 400)])
def test_the_spacing_is_that_of_random_points_to_their_nearest_neighbour(dimension: int, count: int) -> None:
    """In a box without borders: its opposite faces are joined."""
    random, found = np.random.default_rng(5), []
    for _ in range(10):
        points = random.random((count, dimension))
        difference = np.abs(points[:, None] - points[None])
        distances = np.sqrt((np.minimum(difference, 1 - difference) ** 2).sum(axis=2))
        found.append(np.where(np.eye(count, dtype=bool), np.inf, distances).min(axis=1).mean())
    explored = Explored(space(dimension, 10))
    grown(explored, count, np.zeros(count))
    assert explored.spacing() == pytest.approx(np.mean(found), rel=0.05)


def test_the_spread_is_from_the_median_of_the_sample_to_the_lowest_of_all() -> None:
    explored = Explored(space(2, 100))
    grown(explored, 3, np.array([1.0, 4.0, 9.0]))
    explored.add(np.full((1, 2), 0.5), np.array([-2.0]))
    assert explored.spread == 6.0


def test_costs_as_large_as_numbers_can_be_have_an_infinite_spread() -> None:
    explored = Explored(space(2, 100))
    grown(explored, 2, np.array([1.5e308, 1.7e308]))
    assert explored.spread == math.inf
    explored.add(np.full((1, 2), 0.5), np.array([-1e308]))
    assert explored.spread == math.inf


def test_what_is_around_a_point_comes_nearest_last() -> None:
    explored = Explored(space(1, 100))
    explored.add(np.array([[0.5], [0.1], [0.9], [0.4]]), np.array([1.0, 2.0, 3.0, np.inf]))
    points, values = explored.around(np.array([0.46]), 0.4)
    assert points[:, 0].tolist() == [0.1, 0.4, 0.5]
    assert values.tolist() == [2.0, math.inf, 1.0]


def test_a_gain_is_over_the_last_evaluations() -> None:
    progress = Progress(10)
    assert progress.gain == math.inf
    for evaluations, cost in ((5, 9.0), (12, 8.0), (18, 7.0), (22, 6.5)):
        progress.add(evaluations, cost)
    assert (progress.cost, progress.gain) == (6.5, 1.5)
    assert Progress(10).gain == math.inf


def test_a_gain_is_infinite_before_there_is_a_value() -> None:
    progress = Progress(2)
    for evaluations, cost in ((2, math.inf), (4, math.inf), (6, 3.0)):
        progress.add(evaluations, cost)
        assert progress.gain == math.inf
    progress.add(8, 3.0)
    assert progress.gain == 0.0
