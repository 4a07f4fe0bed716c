"""Contrast racing: local searches that descend, a race that promotes, starts by contrast, valleys told apart."""

from __future__ import annotations

import time

import numpy as np
import pytest

from clearance.testing.searching import Function, batch, run, space
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods import contrast_racing
from worker.engine.search.methods.contrast_racing import method
from worker.engine.search.racing.pool import Pool, Rung
from worker.engine.search.racing.samples import Samples
from worker.engine.search.racing.state import CMA, COMPASS, NELDER_MEAD


def bowl(x: Floats) -> Floats:
    return np.asarray((x - 0.62) ** 2 @ np.arange(1.0, x.shape[1] + 1))


def two_basins(x: Floats) -> Floats:
    """A slope with two equal, narrow failures, one of which mirrors the other."""
    far = [np.sqrt(((x - centre) ** 2).sum(axis=1)) for centre in ([0.2, 0.3, 0.5], [0.8, 0.7, 0.5])]
    return np.asarray(np.minimum(*far).clip(max=0.15) * 10 - 1 + 0.1 * np.abs(x[:, 2] - 0.5))


def descend(kind: int, function: Function, dimension: int, evaluations: int) -> tuple[Pool, list[int]]:
    """One local search on its own; the pool, and the sizes of its requests."""
    pool = Pool(dimension, np.random.default_rng(3))
    start = np.full(dimension, 0.3)
    pool.begin(start, float(function(start[None, :])[0]), start, kind, 0.1, 0.03, rung=0)
    rows, sizes = np.array([0]), []
    while pool.state.evaluations[0] < evaluations:
        points = pool.requested(rows)
        assert points.min() >= 0.0
        assert points.max() <= 1.0
        sizes.append(len(points))
        values = function(points)
        pool.tell(rows, np.where(np.isnan(values), np.inf, values))
    return pool, sizes


@pytest.mark.parametrize("dimension", [1, 2, 5, 8])
@pytest.mark.parametrize("kind", [COMPASS, NELDER_MEAD, CMA])
def test_each_local_search_descends_to_the_last_digits(kind: int, dimension: int) -> None:
    pool, _ = descend(kind, bowl, dimension, 250 * dimension)
    assert pool.cost[0] < 1e-9
    assert pool.cost[0] == pytest.approx(bowl(pool.best[:1])[0])
    assert pool.state.kind[0] == CMA  # the others have handed over


@pytest.mark.parametrize("kind", [COMPASS, NELDER_MEAD, CMA])
def test_each_ends_in_the_corner_and_never_takes_what_has_no_value(kind: int) -> None:
    pool, _ = descend(kind, lambda x: x.sum(axis=1), 3, 1500)
    assert pool.cost[0] < 1e-3
    pool, _ = descend(kind, lambda x: np.where(x[:, 0] > 0.5, np.nan, bowl(x)), 3, 1500)
    assert pool.best[0, 0] <= 0.5
    assert pool.best[0] == pytest.approx([0.5, 0.62, 0.62], abs=0.02)
    pool, _ = descend(kind, lambda x: np.full(len(x), np.nan), 3, 500)
    assert np.isnan(pool.cost[0])
    nowhere, _ = descend(kind, lambda x: np.where((x == 0.3).all(axis=1), 1.0, np.nan), 3, 500)
    assert nowhere.best[0].tolist() == [0.3, 0.3, 0.3]


def test_cma_learns_a_narrow_oblique_valley() -> None:
    def valley(x: Floats) -> Floats:
        return np.asarray((x.sum(axis=1) - 2.0) ** 2 * 1e4 + ((x - 0.5) ** 2).sum(axis=1))

    pool, sizes = descend(CMA, valley, 4, 2500)
    assert pool.cost[0] < 1e-6
    assert set(sizes) == {8}


def test_a_dip_on_a_slope_is_the_contrast_and_the_slopes_end_the_lowest() -> None:
    samples = Samples(2, 4, 0.05, np.random.default_rng(1))
    points = samples.draw(200)
    dip = int(np.argmin(np.abs(points - [0.8, 0.5]).max(axis=1)))
    values = points[:, 0].copy()
    values[dip] -= 0.3
    samples.add(points[:120], values[:120])
    samples.add(points[120:], values[120:])
    found = samples.start(by_contrast=True)
    assert found is not None
    assert found[0].tolist() == points[dip].tolist()
    assert found[1] == values[dip]
    lowest = samples.start(by_contrast=False)
    assert lowest is not None
    assert lowest[1] == values.min()


def test_neighbours_and_contrasts_are_those_of_the_whole_sample() -> None:
    samples, random = Samples(3, 6, 0.05, np.random.default_rng(1)), np.random.default_rng(2)
    values = random.standard_normal(300)
    values[::7] = np.inf
    points = samples.draw(300)
    for first in range(0, 300, 60):
        samples.add(points[first : first + 60], values[first : first + 60])
    known, costs = points[np.isfinite(values)], values[np.isfinite(values)]
    distance = np.sqrt(((known[:, None] - known[None]) ** 2).sum(axis=2)) + np.diag(np.full(len(known), 9.0))
    nearest = np.argsort(distance, axis=1)[:, :6]
    assert samples.count == len(known)
    assert samples.contrast[: samples.count] == pytest.approx(costs - np.median(costs[nearest], axis=1))


def test_starts_keep_apart_and_come_closer_when_the_box_is_full() -> None:
    samples = Samples(1, 2, 0.05, np.random.default_rng(1))
    points = samples.draw(100)
    samples.add(points, points[:, 0])
    starts = np.array([found[0][0] for _ in range(60) if (found := samples.start(by_contrast=False)) is not None])
    gaps = [np.abs(starts[i] - starts[:i]).min() for i in range(1, 60)]
    assert len(starts) == len(set(starts)) == 60
    assert min(gaps[:8]) >= 0.05
    assert samples.reach < 0.05


def test_the_best_third_goes_up_in_its_order_but_who_follows_a_better_one() -> None:
    pool, rung = Pool(2, np.random.default_rng(1)), Rung()
    places = [[0.1, 0.1], [0.5, 0.5], [0.51, 0.5], [0.9, 0.9], [0.3, 0.7], [0.7, 0.3]]
    for t, (place, cost) in enumerate(zip(places, [5.0, 1.0, 2.0, 3.0, 4.0, 6.0], strict=True)):
        pool.begin(np.array(place), cost, np.array(place), COMPASS, 0.1, 0.03, rung=0)
        assert rung.next(3, pool) is None
        rung.add(t, cost)
        if t == 2:
            assert rung.next(3, pool) == 1
            pool.rung[1] = 1
    assert rung.next(3, pool) is None  # the second of six follows the first
    for cost in (7.0, 8.0, 9.0):
        rung.add(pool.begin(np.array([0.0, cost / 10]), cost, np.zeros(2), COMPASS, 0.1, 0.03, rung=0), cost)
    assert rung.next(3, pool) == 3


MANY = [pytest.param(name, 6, marks=pytest.mark.nightly) for name in ("Shekel 10", "Hartman 6", "excluded region")]


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("name", "seeds"), [("Shekel 10", 2), ("Hartman 6", 2), ("excluded region", 1), *MANY])
def test_the_known_minimum_is_found_from_every_seed(name: str, seeds: int) -> None:
    for seed in range(seeds):
        function = on_unit_cube(name, seed)
        assert function.gap(run(method, function, function.dimension, 5000, seed=seed, status=3).lowest) < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_both_of_two_failures_are_reported(seed: int) -> None:
    found = run(method, two_basins, 3, 4000, seed=seed)
    bottoms = [m.point for m in found.minima if m.cost < -0.95]
    for centre in ([0.2, 0.3, 0.5], [0.8, 0.7, 0.5]):
        assert sum(np.abs(point - centre).max() < 0.01 for point in bottoms) == 1
    assert len(bottoms) == 2
    assert [m.text for m in found.minima[:2]] == ["polished to the end of the search"] * 2


def test_a_search_cut_short_reports_what_it_has() -> None:
    search = method.search(space(3, 5000, minima := []), method.options())
    points = next(search)
    for _ in range(40):
        points = search.send(batch(two_basins(points)))
    search.close()
    assert len(minima) > 0
    assert {m.text for m in minima} == {"the search ended before it was polished"}


def test_it_continues_when_given_more_than_its_budget() -> None:
    search = method.search(space(3, 500), method.options())
    asked, points = 0, next(search)
    while asked < 3000:
        asked += len(points)
        points = search.send(batch(two_basins(points)))
    search.close()
    assert method.extend is None  # with another budget the search would differ


def test_requests_are_blocks() -> None:
    found = run(method, on_unit_cube("Levy 8", 1), 8, 5000)
    assert len(found.points) / len(found.batches) > 4
    assert len(found.batches[0]) == 500


def test_hops_stay_inside_and_differ() -> None:
    pool = Pool(4, np.random.default_rng(1))
    for place in np.random.default_rng(2).random((12, 4)).round():
        pool.begin(place, float(place.sum()), place, COMPASS, 0.1, 0.03, rung=1)
    made = contrast_racing.hops(pool, 200, np.random.default_rng(3))
    assert made.min() >= 0.0
    assert made.max() <= 1.0
    assert len(np.unique(made, axis=0)) > 150


def test_its_own_time_is_within_its_limit() -> None:
    run(method, bowl, 8, 1500)  # compiles
    search = method.search(space(8, 10_000), method.options())
    points, own, asked = next(search), 0.0, 0
    while asked < 9_900:
        asked += len(points)
        answer = batch(bowl(points))
        began = time.process_time()
        points = search.send(answer)
        own += time.process_time() - began
    search.close()
    assert own / asked < 40e-6  # 20 us on an idle machine; here others may be at work
