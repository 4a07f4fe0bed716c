"""The starts of an estimate: a deep improbable region must not displace a shallow likely one."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy import stats

from tests.bench.rare.judge import carried_out
from worker.engine.rare import earlier, starts
from worker.engine.rare.alarms import NOTHING, Counts
from worker.engine.rare.estimate import Estimate, Refused, estimated, without_far
from worker.engine.rare.evaluated import Floats
from worker.engine.rare.starts import HIGHEST, LEAST, Stored

BUDGET, WIDE = 2000, 10.0
LIKELY = np.array([2.2, 2.2])


def deep_and_likely(u: Floats) -> Floats:
    """Deep below -6 deviations of the first parameter; 0.001 within a small square that is far likelier."""
    return np.where(u[:, 0] < -6.0, -5.0, np.where(np.abs(u - LIKELY).max(axis=1) < 0.3, -0.001, 1.0))


PROBABILITY = float((stats.norm.sf(1.9) - stats.norm.sf(2.5)) ** 2)
"""Of the square."""


def deep() -> Floats:
    a, b = np.meshgrid(np.linspace(-9.9, -6.1, 8), np.linspace(-9.9, 9.9, 21))
    return np.column_stack([a.ravel(), b.ravel()])


def stored(points: Floats, sampled: int = 0) -> Stored:
    """Violations in deviations, over a range of ten on both sides; the last ones are of the independent sample."""
    of = np.arange(len(points)) >= len(points) - sampled
    return Stored(points / (2.0 * WIDE) + 0.5, deep_and_likely(points), points, of)


def test_the_likely_violation_is_among_the_starts_and_was_not() -> None:
    known = stored(np.vstack([deep(), LIKELY]))
    assert len(known.points) - 1 in starts.chosen(known, 500)
    assert len(known.points) - 1 not in earlier.chosen(known.points, known.costs, 500)


def test_the_starts_are_in_turns_the_lowest_the_most_likely_and_of_the_sample() -> None:
    points = np.array([[-8.0, 0.0], [2.0, 2.1], [-6.1, 0.0], [6.5, -6.0], [2.1, 2.1], [2.0, 2.2]])
    known = Stored(points / 20.0 + 0.5, np.arange(6.0) - 10.0, points, np.arange(6) == 3)
    assert starts.chosen(known, BUDGET).tolist() == [0, 1, 3, 2]
    assert starts.chosen(known, 50 * 2).tolist() == [0, 1]


def test_the_independent_sample_has_its_turn_among_many_that_are_more_likely() -> None:
    many = np.array([[x, y] for x in np.arange(2.0, 7.0, 1.1) for y in np.arange(-6.0, 6.0, 1.1)])
    known = stored(np.vstack([deep(), many, [[5.0, 7.5], [-5.0, 7.5]]]), sampled=2)
    assert {len(known.points) - 2, len(known.points) - 1} <= set(starts.chosen(known, 1000).tolist())


def test_without_a_violation_there_is_no_start() -> None:
    known = Stored(np.ones((2, 2)), np.full(2, np.inf), np.ones((2, 2)), np.ones(2, dtype=bool))
    assert not len(starts.chosen(known, BUDGET))
    empty = Stored(np.empty((0, 2)), np.empty(0), np.empty((0, 2)), np.empty(0, dtype=bool))
    assert not len(starts.chosen(empty, BUDGET))


def of(
    costs: Callable[[Floats], Floats],
    first: Floats,
    known: Floats | None,
    certified: Counts = NOTHING,
    budget: int = BUDGET,
    seed: int = 1,
) -> Estimate:
    asking = estimated(first, 0.0, budget, np.random.default_rng(seed), stored=known, certified=certified)
    found, requested = carried_out(asking, costs)
    assert isinstance(found, Estimate)
    assert requested == budget
    return found


@pytest.mark.parametrize("seed", range(3))
def test_a_stored_violation_of_no_known_mode_is_examined(seed: int) -> None:
    """It was stored before the estimate, which its origins state."""
    found = of(deep_and_likely, deep()[:1], np.vstack([deep(), LIKELY]), seed=seed)
    assert found.alarms or found.interval.low < PROBABILITY < found.interval.high
    (mode,) = (mode for mode in found.modes if mode.design[0] > 0.0)
    assert mode.origins == (1 + len(deep()),)


def test_more_violations_of_no_known_mode_than_the_budget_suffices_for_raise_an_alarm() -> None:
    """A box around a point of each of 32 orthants, of which no tangent plane has another."""
    corners = np.array(list(product((-1.3, 1.3), repeat=5)))

    def boxes(u: Floats) -> Floats:
        return np.where((np.abs(np.abs(u) - 1.3) < 0.4).all(axis=1) | (u[:, 0] < -6.0), -1.0, 1.0)

    found = of(boxes, np.array([[-7.0, 0.0, 0.0, 0.0, 0.0]]), corners, budget=1000)
    assert "unexplained" in {alarm.why for alarm in found.alarms}


def half_space(u: Floats) -> Floats:
    return 6.0 + u[:, 0]


def test_the_sample_of_the_run_contradicts_an_interval_that_the_small_sample_of_the_stage_does_not() -> None:
    """42 violations of a million, where the estimate expects 0.001."""
    million = Counts(42, 0, 1_000_000)
    (alarm,) = of(half_space, deep()[:1], None, million).alarms
    assert (alarm.why, alarm.value, alarm.counts) == ("sample", 42.0, million)
    assert of(half_space, deep()[:1], None, Counts(0, 0, 1_000_000)).alarms == ()


def test_correlated_draws_that_were_drawn_again_within_the_bounds_may_violate() -> None:
    assert of(half_space, deep()[:1], None, Counts(42, 0, 1_000_000, 1e-4)).alarms == ()


def test_violations_far_in_a_tail_stay_there() -> None:
    """At seven and nine deviations, where an earlier version moved them to six."""
    uniform = np.array([[1.28e-12], [1.13e-19], [1.0 - 1.28e-12]])
    assert starts.normal(uniform).ravel() == pytest.approx([-7.0, -9.0, 7.0], abs=0.01)
    assert not starts.moved(uniform).any()
    assert starts.moved(np.array([[0.0], [1.0], [LEAST], [HIGHEST]])).tolist() == [True, True, False, False]


def test_if_all_known_violations_are_farther_the_refusal_states_this() -> None:
    none, budget = Refused("no_violation"), Refused("budget", 1000)
    assert without_far(none, np.array([True, False])) == Refused("too_far")
    assert without_far(none, np.array([False])) == none
    assert without_far(budget, np.array([True])) == budget
