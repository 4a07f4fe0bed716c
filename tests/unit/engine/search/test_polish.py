"""Polishing a minimum where gradients and a compass end in dips, and finding further ones: of crossed coordinates, and
from random points."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from clearance.testing.searching import Function, batch
from tests.given.wells import wells
from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.basin import Basin, Rules
from worker.engine.search.parts.polish import LEAST, WAVE, Polish, crossed, explored, polished, sharpened

RULES = Rules(distance=0.03, barrier=0.05, at_most=20, rugged=1e-6)
WELLS = ((0.2, 0.2, 1.0), (0.8, 0.8, 1.0), (0.8, 0.2, 0.9))


TURNED = np.array([[0.8, 0.6], [-0.6, 0.8]])


def rugged(x: Floats) -> Floats:
    """Weierstrass's function about 0.3, turned: a cusp among dips of every size, none as low as 0."""
    k = np.arange(14)
    along = (x - 0.3) @ TURNED
    return np.asarray((0.6**k * (1.0 - np.cos(2.0 * np.pi * 3.0**k * along[:, :, None]))).sum(axis=(1, 2)))


def evaluated(part: Generator[Floats, Batch, Any], function: Function) -> tuple[Any, int]:
    """What a part returns, and its evaluations."""
    made = 0
    try:
        points = next(part)
        while True:
            made += len(points)
            points = part.send(batch(function(points)))
    except StopIteration as end:
        return end.value, made


def after_polish(function: Function, starts: list[list[float]], room: int = 0) -> tuple[list[Basin], int]:
    """The basins of these starts, polished, and the evaluations that this took."""
    found = [Basin(np.array(p), float(function(np.array([p]))[0]), [i]) for i, p in enumerate(starts)]
    _, made = evaluated(polished(found, RULES, Polish(lambda: room, np.random.default_rng(1))), function)
    return found, made


@pytest.mark.nightly
def test_a_minimum_among_dips_is_polished_by_a_strategy() -> None:
    reached = {0: 0, 20_000: 0}
    for start in 0.3 + np.random.default_rng(3).uniform(-0.03, 0.03, (72, 2)):
        costs = {}
        for evolving in reached:
            (found,), _ = after_polish(rugged, [start.tolist()], evolving)
            costs[evolving] = found.cost
            reached[evolving] += found.cost < 1e-9
        assert costs[20_000] < costs[0]
    assert reached[0] == 0
    assert reached[20_000] >= 5  # a fifth of them; which ones depends on the last bits of the processor


def test_a_smooth_minimum_takes_no_strategy() -> None:
    function, starts = wells(*WELLS), [[0.21, 0.22], [0.79, 0.8]]
    _, without = after_polish(function, starts)
    found, made = after_polish(function, starts, 20_000)
    assert made == without
    assert [b.cost for b in found] == pytest.approx([-1.0, -1.0], abs=1e-6)


@pytest.mark.parametrize("evolving", [100, 1000])
def test_strategies_take_no_more_than_they_may(evolving: int) -> None:
    starts = [[0.312, 0.291], [0.9, 0.31], [0.6, 0.62]]
    _, without = after_polish(rugged, starts)
    _, made = after_polish(rugged, starts, evolving)
    assert made <= without + evolving


def test_minima_that_end_at_one_place_are_one() -> None:
    found, _ = after_polish(rugged, [[0.312, 0.291], [0.36, 0.291]], 50_000)
    lowest = [b for b in found if np.abs(b.point - 0.3).max() < RULES.distance]
    assert len(lowest) == 1
    assert sorted(m for b in found for m in b.members) == [0, 1]


def test_the_same_seed_gives_the_same_polish() -> None:
    one, other = (after_polish(rugged, [[0.312, 0.291]], 5_000) for _ in range(2))
    assert one[1] == other[1]
    assert np.array_equal(one[0][0].point, other[0][0].point)


def basins(function: Function, points: list[list[float]]) -> list[Basin]:
    """Basins at these points, lowest first."""
    costs = function(np.array(points))
    return sorted(
        (Basin(np.array(p), float(c), [i]) for i, (p, c) in enumerate(zip(points, costs, strict=True))),
        key=lambda b: b.cost,
    )


def two_cusps(x: Floats) -> Floats:
    """The rugged function at 0.3 and again at 0.8: two minima of cost 0."""
    return np.minimum(rugged(x), rugged(x - 0.5))


def test_a_minimum_nearly_as_low_as_the_lowest_becomes_as_low() -> None:
    found = basins(two_cusps, [[0.3, 0.3], [0.8004, 0.7996]])
    gap = found[1].cost
    _, made = evaluated(sharpened(found, 2 * gap, RULES, 20_000, np.random.default_rng(1)), two_cusps)
    assert found[1].cost < 0.01 * gap
    assert 0 < made <= 20_000


def test_those_as_low_as_the_lowest_and_those_far_above_it_stay() -> None:
    found = basins(wells(*WELLS), [[0.2, 0.2], [0.8, 0.8], [0.8, 0.2]])
    before = [(b.point.copy(), b.cost) for b in found]
    _, made = evaluated(sharpened(found, 0.05, RULES, 20_000, np.random.default_rng(1)), wells(*WELLS))
    assert made == 0
    assert all(
        np.array_equal(b.point, point) and b.cost == cost for b, (point, cost) in zip(found, before, strict=True)
    )


def waves(x: Floats) -> Floats:
    """A sum over the parameters, whose minima are at 1/6, 1/2 and 5/6 of each: 27 of cost 0 in three."""
    return np.asarray((1.0 + np.cos(6.0 * np.pi * x)).sum(axis=1))


def test_crossed_coordinates_lead_to_every_minimum_of_a_sum() -> None:
    known = basins(waves, [[1 / 6] * 3, [1 / 2] * 3, [5 / 6] * 3])
    while fresh := evaluated(crossed(known, 0.01, RULES, 5_000, np.random.default_rng(1)), waves)[0]:
        known += fresh
    assert len({tuple(np.round(6 * b.point).astype(int)) for b in known}) == len(known) == 27
    assert max(b.cost for b in known) < 1e-9


def test_crossed_coordinates_of_dependent_parameters_take_few_evaluations() -> None:
    known = basins(wells(*WELLS), [[0.2, 0.2], [0.8, 0.8]])
    fresh, made = evaluated(crossed(known, -0.99, RULES, 5_000, np.random.default_rng(1)), wells(*WELLS))
    assert (fresh, made) == ([], 2)


@pytest.mark.parametrize(
    ("points", "room"), [([[0.2, 0.2]], 5_000), ([[0.2], [0.8]], 5_000), ([[0.2, 0.2], [0.8, 0.8]], 1)]
)
def test_nothing_is_crossed_without_a_pair_parameters_or_evaluations(points: list[list[float]], room: int) -> None:
    known = basins(waves, points)
    assert evaluated(crossed(known, 10.0, RULES, room, np.random.default_rng(1)), waves) == ([], 0)


def test_random_points_lead_to_the_minima_that_are_not_known() -> None:
    known = [Basin(np.array([0.2, 0.2]), -1.0, [0])]
    fresh, made = evaluated(explored(known, 0.0, RULES, 20_000, np.random.default_rng(1)), wells(*WELLS))
    ends = sorted(tuple(np.round(b.point, 2).tolist()) for b in fresh if b.cost < -0.5)
    assert ends == [(0.8, 0.2), (0.8, 0.8)]
    assert made <= 20_000


def test_none_begins_with_too_few_evaluations() -> None:
    known = [Basin(np.array([0.2, 0.2]), -1.0, [0])]
    room = WAVE * LEAST * 2 - 1
    fresh, made = evaluated(explored(known, 0.0, RULES, room, np.random.default_rng(1)), wells(*WELLS))
    assert (fresh, made) == ([], 0)


def test_a_start_without_a_value_leads_nowhere() -> None:
    known = [Basin(np.array([0.2, 0.2]), -1.0, [0])]

    def fails(x: Floats) -> Floats:
        return np.where(x[:, 0] + x[:, 1] > 0.5, np.nan, wells(*WELLS)(x))

    fresh, made = evaluated(explored(known, 0.0, RULES, 20_000, np.random.default_rng(1)), fails)
    assert made <= 20_000
    assert all(np.isfinite(b.cost) for b in fresh)
    evaluations = {"failed": 0}

    def nothing(x: Floats) -> Floats:
        evaluations["failed"] += len(x)
        return np.full(len(x), np.nan)

    fresh, made = evaluated(explored(known, 0.0, RULES, 1_700, np.random.default_rng(1)), nothing)
    assert (fresh, made) == ([], evaluations["failed"])
