"""Differential evolution: one generation a batch, ends by its tolerance, options are SciPy's, restarts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from campaigns.codes import StopCode
from clearance.testing.searching import run
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats
from worker.engine.search.methods.differential_evolution import method


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


def test_points_without_a_value_lose() -> None:
    found = run(method, lambda x: np.where(x[:, 0] > 0.5, np.nan, bowl(x)), 2, 2000)
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
    extended = method.extend(method.options(), 1000)
    long = run(method, bowl, 2, len(short.points) + 1000, options={"restarts": extended.restarts})
    assert len(long.points) >= len(short.points) + 1000
    assert long.minima[0].text == short.text
    assert len(long.minima) == 2
    assert np.array_equal(long.points[: len(short.points)], short.points)
