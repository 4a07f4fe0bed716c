"""Monte Carlo: one random stream, shaped by the campaign's distributions; quasi-random points; early stopping."""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from campaigns.codes import StopCode
from clearance.testing.searching import run, space
from tests.given.sampled_stages import PROBABILITY, THRESHOLD, asked, context, evaluate
from tests.given.stated_facts import facts
from worker.engine.search.base import Floats
from worker.engine.search.methods import monte_carlo
from worker.engine.search.methods.monte_carlo import NO_SAMPLE
from worker.engine.search.parts.proportion import interval
from worker.engine.stages import search
from worker.engine.stages.parts.claims import bound


def test_monte_carlo_draws_from_the_distributions_of_the_campaign() -> None:
    drawn = run(monte_carlo.method, lambda x: x[:, 0], 3, 9000).points
    assert drawn.shape == (9000, 3)
    assert np.array_equal(drawn, np.random.default_rng(1).random((9000, 3)))
    shaped = dataclasses.replace(space(3, 100), quantile=np.square)
    assert np.array_equal(next(monte_carlo.method.search(shaped, monte_carlo.Options())), drawn[:100] ** 2)


def test_a_longer_sample_begins_as_the_shorter_one() -> None:
    short, long = (run(monte_carlo.method, lambda x: x[:, 0], 2, budget).points for budget in (700, 9000))
    assert np.array_equal(short, long[:700])


def drawn(sampling: str, count: int, dimension: int = 2, **options: Any) -> Floats:
    given = {"sampling": sampling, **options}
    return run(monte_carlo.method, lambda x: x[:, 0], dimension, count, options=given).points


@pytest.mark.parametrize("count", [1, 7, 300, 5000])
def test_a_latin_hypercube_has_one_point_in_every_slice(count: int) -> None:
    points = drawn("latin_hypercube", count, 3)
    assert points.shape == (count, 3)
    for column in points.T:
        assert sorted(np.floor(column * count).astype(int)) == list(range(count))


def test_scrambled_sobol_points_are_balanced() -> None:
    points = drawn("sobol", 4096 * 2)
    assert (points > 0).all()
    assert (points < 1).all()
    for first in (0, 4096):
        cells = np.floor(points[first : first + 4096] * 64).astype(int)
        assert len(np.unique(cells, axis=0)) == 4096  # one in every cell of 64 by 64
    assert not np.array_equal(points, drawn("plain", 4096 * 2))


@pytest.mark.parametrize("sampling", ["plain", "sobol"])
def test_a_longer_sample_begins_as_the_shorter_one_whatever_the_interim_analyses(sampling: str) -> None:
    whole = drawn(sampling, 9000)
    assert np.array_equal(drawn(sampling, 700), whole[:700])
    assert np.array_equal(drawn(sampling, 9000, interval=1e-9), whole)
    assert len(np.unique(whole, axis=0)) == 9000


def test_how_a_sample_is_extended() -> None:
    for sampling in ("plain", "sobol"):
        options = monte_carlo.Options(sampling=sampling)  # type: ignore[arg-type]
        assert monte_carlo.extend(options, 500) == replace(options, continued=True)
    with pytest.raises(ValueError, match="a Latin hypercube is designed for its number of samples and cannot be"):
        monte_carlo.extend(monte_carlo.Options(sampling="latin_hypercube"), 500)
    with pytest.raises(ValueError, match="start it again with a narrower interval"):
        monte_carlo.extend(monte_carlo.Options(interval=0.01), 500)


# Stopping early


def test_the_interim_analyses_spend_the_error_and_no_more() -> None:
    spent = []
    for looks in range(1, 40):
        size = int(np.ceil(100 * 1.5 ** (looks - 1)))
        assert monte_carlo.interim_analyses(size, 0.95)[0] == looks
        assert monte_carlo.interim_analyses(size + 1, 0.95)[0] == looks + 1
        spent.append(1 - monte_carlo.interim_analyses(size, 0.95)[1])
    assert spent[0] == pytest.approx(0.025)
    assert sum(spent) == pytest.approx(0.05 * (1 - 1 / 40))
    assert monte_carlo.interim_analyses(3, 0.95)[0] == 1


def test_the_two_sided_interval() -> None:
    # Clopper and Pearson's own example: 1 of 10 with 95 % is 0.0025 to 0.445.
    assert interval(1, 10, 0.95) == pytest.approx((0.00253, 0.44502), abs=1e-5)
    assert interval(0, 10, 0.95) == pytest.approx((0.0, 0.30850), abs=1e-5)
    assert interval(10, 10, 0.95) == pytest.approx((0.69150, 1.0), abs=1e-5)


STOPPING = asked(
    {"search": [{"method": "monte_carlo", "evaluations": 20_000, "options": {"interval": 0.03}}]},
)


def test_it_stops_at_the_first_interim_analysis_with_a_narrow_interval() -> None:
    run = context(STOPPING)
    found = search.run(run, 0).result
    assert found.stop is not None
    columns = run.store.evaluations(0)
    assert columns is not None
    assert found.stop.kind == "rule"
    assert found.stop.code == StopCode.PRECISE
    violated = np.cumsum(columns.costs[:, 0] <= THRESHOLD)
    widths = []
    for looks in range(1, 20):
        size = int(np.ceil(100 * 1.5 ** (looks - 1)))
        level = 1 - 0.05 / (looks * (looks + 1))
        low, high = interval(int(violated[size - 1]), size, level)
        widths.append(high - low)
        if size == len(columns.status):
            break
    assert widths[-1] < 0.03
    assert min(widths[:-1]) >= 0.03
    told = found.sample
    assert told is not None
    assert told.looks == len(widths)
    assert told.upper_bound == bound(told.violations, told.samples, level)
    assert facts(told.statement)[-2:] == [told.looks, pytest.approx(level, abs=1e-6)]


@pytest.mark.parametrize("seeds", [150, pytest.param(400, marks=pytest.mark.nightly)])
def test_the_bound_of_a_sample_that_stops_early_has_its_stated_coverage(seeds: int) -> None:
    held, naive, stopped = 0, 0, []
    for seed in range(seeds):
        found = search.run(context(STOPPING, seed=seed), 0).result.sample
        assert found is not None
        assert found.upper_bound is not None
        held += found.upper_bound >= PROBABILITY
        naive += bound(found.violations, found.samples, 0.95) >= PROBABILITY
        stopped.append(found.samples)
    assert held >= 0.93 * seeds
    assert len(set(stopped)) > 2  # it does stop by what it sees
    assert naive < held


def test_a_sample_that_ends_by_its_budget_has_spent_its_interim_analyses() -> None:
    given = asked({"search": [{"method": "monte_carlo", "evaluations": 300, "options": {"interval": 0.001}}]})
    told = search.run(context(given), 0).result.sample
    assert told is not None
    assert (told.samples, told.looks) == (300, 4)  # at 100, 150, 225, and now
    assert told.upper_bound == bound(told.violations, 300, 1 - 0.05 / 20)


def test_failed_and_excluded_evaluations_with_interim_analyses() -> None:
    given = asked({"search": [{"method": "monte_carlo", "evaluations": 20_000, "options": {"interval": 0.2}}]})
    flown = evaluate(failing=lambda x: x[:, 0] > 0.9, excluded=lambda x: x[:, 1] > 0.5)
    told = search.run(context(given, flown), 0).result.sample
    assert told is not None
    assert told.excluded > 0.4 * told.samples
    assert told.violations >= told.failed > 0


@pytest.mark.parametrize(
    ("sampling", "points"), [("latin_hypercube", "points of a Latin hypercube"), ("sobol", "Sobol")]
)
def test_points_that_are_no_independent_sample_bound_nothing(sampling: str, points: str) -> None:
    given = asked({"search": [{"method": "monte_carlo", "evaluations": 1000, "options": {"sampling": sampling}}]})
    told = search.run(context(given), 0).result.sample
    assert told is not None
    assert told.upper_bound is None
    assert told.violations == pytest.approx(1000 * PROBABILITY, abs=6)
    assert points in told.text
    assert NO_SAMPLE in told.text
