"""Differential evolution: one generation a batch, ends by its tolerance, options are SciPy's, restarts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from campaigns.codes import StopCode
from clearance.testing.searching import Searched
from clearance.testing.searching import run as searched
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods.differential_evolution import method


def run(*given: Any, options: Mapping[str, object] | None = None, **more: Any) -> Searched:
    """As published, unless other options are given."""
    return searched(*given, options={"as_published": True, **(options or {})}, **more)


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


def test_it_is_scipys_one_generation_a_batch() -> None:
    found = run(method, bowl, 2, 100_000)
    theirs = differential_evolution(
        lambda x: bowl(x.T), [(0, 1)] * 2, polish=False, updating="deferred", vectorized=True, rng=1, maxiter=10**6
    )
    assert set(map(len, found.batches)) == {30}
    assert len(found.batches) == theirs.nfev  # of calls
    assert found.lowest == theirs.fun
    (minimum,) = found.minima
    assert (minimum.cost, minimum.evaluations, minimum.text) == (theirs.fun, len(found.points), found.text)
    assert ending(found.text) == (StopCode.CONVERGED, {"generations": theirs.nit})


@pytest.mark.parametrize("name", ["Shekel 10", "Rastrigin 5"])
def test_the_known_minimum_is_found(name: str) -> None:
    function = on_unit_cube(name, 2)
    found = run(method, function, function.dimension, 20_000)
    assert function.gap(found.lowest) < 0.01


@pytest.mark.parametrize("name", ["Shekel 10", "Ackley 10", "Hartman 6"])
def test_the_adaptive_one_finds_the_known_minimum_sooner_and_uses_its_budget(name: str) -> None:
    function = on_unit_cube(name, 2)
    found = searched(method, function, function.dimension, 5000)
    assert function.gap(found.lowest) < 0.01
    assert (found.text, len(found.points) >= 5000) == (None, True)
    assert found.lowest < run(method, function, function.dimension, 5000).lowest
    assert len(found.batches[0]) == max(3 * function.dimension, 10)


def test_the_adaptive_one_restarts_with_a_larger_population_and_reports_each() -> None:
    found = searched(method, bowl, 2, 6000)
    sizes = list(dict.fromkeys(map(len, found.batches)))
    assert sizes[:3] == [10, 15, 20]
    assert len(found.minima) >= 3
    assert found.minima[0].cost < 1e-15
    flat = searched(method, lambda x: np.zeros(len(x)), 2, 500)
    assert len(flat.points) >= 500


@pytest.mark.parametrize("option", [{"recombination": 0.2}, {"tolerance": 0.1}, {"mutation": 0.3}, {"dither": 0.0}])
def test_stated_options_of_scipys_strategies_are_never_ignored(option: dict[str, float]) -> None:
    found, named = (searched(method, bowl, 3, 500, options=o) for o in (option, {"strategy": "best1bin", **option}))
    assert np.array_equal(found.points, named.points)


@pytest.mark.parametrize("as_published", [True, False])
def test_points_without_a_value_lose(as_published: bool) -> None:
    found = run(
        method, lambda x: np.where(x[:, 0] > 0.5, np.nan, bowl(x)), 2, 2000, options={"as_published": as_published}
    )
    assert (np.stack(found.batches[-1])[:, 0] <= 0.5).all()
    assert found.lowest < 1e-3
    nothing = run(method, lambda x: np.full(len(x), np.nan), 2, 500)
    assert (nothing.minima, nothing.text) == ([], None)


def test_options_reach_it() -> None:
    assert len(run(method, bowl, 3, 1000, options={"population": 7}).batches[0]) == 21
    plain, other = (run(method, bowl, 3, 400, options={"strategy": s}).points for s in ("best1bin", "rand2exp"))
    assert not np.array_equal(plain, other)
    still = run(method, bowl, 3, 90, options={"mutation": 0.0, "dither": 0.0, "recombination": 0.0})
    assert len(still.batches) == 2


def test_extended_it_repeats_its_first_points() -> None:
    short = run(method, bowl, 2, 100_000)
    assert method.extend is not None
    extended = method.extend(method.options(as_published=True), 1000)
    long = run(method, bowl, 2, len(short.points) + 1000, options=asdict(extended))
    assert len(long.points) >= len(short.points) + 1000
    assert long.minima[0].text == short.text
    assert len(long.minima) == 2
    assert np.array_equal(long.points[: len(short.points)], short.points)
