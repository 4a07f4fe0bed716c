"""lq-CMA-ES: the points of its library's own loop, parts of generations, restarts, evaluations that fail."""

from __future__ import annotations

import warnings
from contextlib import suppress

import numpy as np
import pytest

from clearance.testing.searching import batch, run, space
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods import lq_cma_es
from worker.engine.search.methods.lq_cma_es import BEHIND, method
from worker.engine.search.parts.explored import Explored
from worker.engine.search.parts.one_thread import one_thread
from worker.engine.search.parts.pycma import strategy


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.4) ** 2 * 10.0 ** np.arange(x.shape[1])).sum(axis=1))


LIBRARY = {"initial": 0, "deviation": 0.3}
"""The options of pycma's own loop."""


def library(function: object, dimension: int, budget: int, seed: int) -> Floats:
    """The points at which pycma's own loop evaluates, from the same start and random numbers."""
    import cma

    random, asked = np.random.default_rng(seed), []

    def cost(x: Floats) -> float:
        asked.append(np.array(x))
        if len(asked) >= budget:
            raise StopIteration
        return float(function(np.clip(np.array(x), 0, 1)[None, :])[0])  # type: ignore[operator]

    options = {
        "bounds": [0.0, 1.0], "popsize": 4 + int(3 * np.log(dimension)), "seed": np.nan, "tolx": 1e-5,
        "verbose": -9, "verb_log": 0, "randn": lambda *shape: random.standard_normal(shape),
    }  # fmt: skip
    start = random.random(dimension)
    with warnings.catch_warnings(), one_thread(), suppress(StopIteration):
        warnings.simplefilter("ignore")
        cma.fmin_lq_surr2(cost, start, 0.3, options)
    return np.array(asked)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("name", "budget"), [("Hartman 6", 80), ("Branin", 50)])
def test_its_points_are_those_of_the_librarys_own_loop(name: str, budget: int) -> None:
    f = on_unit_cube(name, 3)
    own = run(method, f, f.dimension, budget, seed=7, options=LIBRARY).points[:budget]
    assert np.array_equal(own, library(f, f.dimension, budget, 7))


def test_a_quadratic_cost_is_solved_in_tens_of_evaluations() -> None:
    found = run(method, bowl, 4, 80)
    assert found.lowest < 1e-9


def test_a_generation_is_evaluated_in_growing_parts() -> None:
    found = run(method, lambda x: np.sin(1e5 * x).sum(axis=1), 2, 60, options={"population": 20, "initial": 0})
    sizes = list(map(len, found.batches))
    assert sizes[:5] == [5, 3, 4, 6, 2], "no model ranks noise: 5, 8, 12, 18, 20 of 20 points"
    alone = run(method, bowl, 4, 80)
    assert np.mean(list(map(len, alone.batches[20:]))) < 1.5, "the model of a bowl is trusted"


def test_requests_are_multiples_of_the_number_of_slots() -> None:
    found = run(method, bowl, 6, 90, options={"at_once": 3, "population": 12})
    assert {len(b) % 3 for b in found.batches} == {0}
    assert found.lowest < 1e-3


def test_restarts_of_the_librarys_own_loop_double_the_population() -> None:
    """No model ranks a flat cost, so every generation is evaluated in full."""
    found = run(method, lambda x: np.zeros(len(x)), 2, 400, options=LIBRARY)
    assert found.text is None
    assert len(found.minima) >= 3
    assert [m.evaluations % size for m, size in zip(found.minima[:2], (6, 12), strict=True)] == [0, 0]
    assert "the cost" in found.minima[0].text


def test_every_fourth_restart_doubles_the_population_and_every_one_begins_narrower(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[tuple[float, int]] = []

    def noted(start: Floats, deviation: float, population: int, *rest: object) -> object:
        begun.append((round(deviation, 12), population))
        return strategy(start, deviation, population, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(lq_cma_es, "strategy", noted)
    run(method, bowl, 2, 180)
    assert begun[:5] == [(0.25, 6), *[(0.15, 6)] * 3, (0.15, 12)]


def test_stars_come_first_and_the_first_descent_begins_at_the_lowest_point() -> None:
    found = run(method, bowl, 3, 60)
    sizes = list(map(len, found.batches))
    assert sizes[:2] == [7, 6], "the centre and two points on each axis; two more on each axis"
    first = np.concatenate(found.batches[:2])
    assert np.array_equal(found.minima[0].start, first[np.argmin(bowl(first))])


def test_a_restart_follows_a_star_around_the_lowest_point() -> None:
    found = run(method, two, 3, 100, seed=2)
    end = 0
    while np.concatenate(found.values[: end + 1]).min() > found.minima[0].cost or len(found.batches[end]) < 6:
        end += 1
    lowest = found.points[: sum(map(len, found.batches[:end]))]
    middle = lowest[np.argmin(two(lowest))]
    assert ((found.batches[end] != middle).sum(axis=1) == 1).all()


def test_a_restart_after_long_descents_adds_to_the_sample() -> None:
    random, explored = np.random.default_rng(1), Explored(space(3, 500))
    explored.add(random.random((100, 3)), random.random(100))
    asked = lq_cma_es._start(space(3, 500), method.options(), explored)
    star = next(asked)
    sample = asked.send(batch(np.full(6, 9.0)))
    assert (len(star), len(sample)) == (6, int(0.4 * 106) - 6)
    low = np.append(np.full(len(sample) - 1, 9.0), -1.0)
    with pytest.raises(StopIteration) as start:
        asked.send(batch(low))
    assert np.array_equal(start.value.value, sample[-1])


def test_stars_fill_the_places_side_by_side_too() -> None:
    sizes = [len(b) for b in run(method, two, 3, 100, options={"at_once": 5, "population": 10}).batches]
    assert sizes[0] == 10
    assert {size % 5 for size in sizes} == {0}


def two(x: Floats) -> Floats:
    """A wide bowl down to 1 and a narrow one down to 0."""
    wide, deep = ((x - 0.7) ** 2).sum(axis=1), ((x - 0.2) ** 2).sum(axis=1)
    return np.minimum(1 + wide, 12 * deep)


@pytest.mark.nightly
def test_a_search_that_begins_in_the_wrong_valley_leaves_it_for_others() -> None:
    found = [run(method, two, 3, 200, seed=seed) for seed in (1, 4, 8)]  # of ten, 2 and 9 miss the right one
    assert all(f.minima[0].cost > 0.5 for f in found), "they begin in the wrong valley"
    assert all(f.lowest < 0.5 for f in found)
    assert all(len(f.minima) >= 3 and f.minima[0].evaluations < 60 for f in found)
    behind = [(f, i) for f in found for i, m in enumerate(f.minima) if m.text == BEHIND]
    assert behind
    for f, i in behind:
        assert min(m.cost for m in f.minima[:i]) < f.minima[i].cost


def test_a_search_whose_sample_fails_samples_on() -> None:
    sizes, failed = [], 40
    search = method.search(space(2, 200), method.options())
    points = next(search)
    while sum(sizes) < failed:
        sizes.append(len(points))
        points = search.send(batch(np.full(len(points), np.nan)))
    assert (sizes[:2], set(sizes[2:])) == ([5, 4], {2})
    values = np.arange(float(len(points)))
    nearby = search.send(batch(values))
    search.close()
    assert np.linalg.norm(nearby - points[0], axis=1).max() < 1.0, "it begins at the first that has a value"


def test_what_fails_is_replaced_by_the_next_best_and_never_modelled(monkeypatch: pytest.MonkeyPatch) -> None:
    from cma.fitness_models import LQModel

    seen: list[float] = []
    add = LQModel.add_data_row

    def note(self: object, x: Floats, f: float) -> object:
        seen.append(f)
        return add(self, x, f)

    monkeypatch.setattr(LQModel, "add_data_row", note)
    found = run(method, lambda x: np.where(x[:, 0] > 0.4, np.nan, bowl(x)), 3, 120)
    values = np.concatenate(found.values)
    assert 0 < np.isnan(values).sum() < 60
    assert seen
    assert np.isfinite(seen).all()
    assert found.lowest < 1e-3, "the minimum is at the edge of what fails"


@pytest.mark.nightly
def test_a_hole_at_the_bottom_does_not_take_most_evaluations() -> None:
    """In the model's order alone, and with its minimum in every generation, 61 to 67 % of the second half fail."""
    fractions = []
    for seed in (1, 2, 3):
        found = run(method, lambda x: np.where(np.abs(x - 0.4).max(axis=1) < 0.1, np.nan, bowl(x)), 3, 110, seed=seed)
        fractions.append(np.isnan(np.concatenate(found.values)[55:]).mean())
        assert found.lowest < 0.0102, "the edge of the hole is at 0.01"
    assert np.mean(fractions) < 0.4


def test_a_generation_of_failures_is_evaluated_in_full() -> None:
    search = method.search(space(2, 100), method.options())
    points, asked = next(search), 0
    for _ in range(40):
        asked += len(points)
        points = search.send(batch(np.full(len(points), np.nan)))
    search.close()
    assert asked > 40


def test_a_population_stops_growing_where_the_model_ranks_nearly_all() -> None:
    """Without a limit it doubles every twenty evaluations on a bowl, and asks for millions of points."""
    sizes, ask = [], strategy

    def noted(start: Floats, deviation: float, population: int, *rest: object) -> object:
        sizes.append(population)
        return ask(start, deviation, population, *rest)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lq_cma_es, "strategy", noted)
        patch.setattr(lq_cma_es, "LARGEST", 20)
        patch.setattr(lq_cma_es, "ALIKE", 1)
        run(method, bowl, 2, 150)
        assert sizes[:3] == [6, 12, 20]
        assert set(sizes[2:]) == {20}
        sizes.clear()
        run(method, bowl, 2, 100, options={"population": 30})
        assert set(sizes) == {30}


@pytest.mark.parametrize("scale", [1.7e308, 1e-300])
def test_costs_at_the_limits_of_numbers_are_searched(scale: float) -> None:
    found = run(method, lambda x: scale * np.sin(9 * x.sum(axis=1)), 2, 60)
    assert found.lowest < -0.99 * scale
