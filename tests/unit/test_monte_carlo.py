"""Monte Carlo: one stream of numbers, shaped by the campaign's distributions."""

from __future__ import annotations

import dataclasses

import numpy as np

from tests.unit.searching import run, space
from worker.search import monte_carlo


def test_monte_carlo_draws_from_the_distributions_of_the_campaign() -> None:
    drawn = run(monte_carlo.method, lambda x: x[:, 0], 3, 9000).points
    assert drawn.shape == (9000, 3)
    assert np.array_equal(drawn, np.random.default_rng(1).random((9000, 3)))
    shaped = dataclasses.replace(space(3, 100), quantile=np.square)
    assert np.array_equal(next(monte_carlo.method.search(shaped, monte_carlo.Options())), drawn[:100] ** 2)


def test_a_longer_sample_begins_as_the_shorter_one() -> None:
    short, long = (run(monte_carlo.method, lambda x: x[:, 0], 2, budget).points for budget in (700, 9000))
    assert np.array_equal(short, long[:700])
