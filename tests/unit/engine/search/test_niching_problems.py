"""The niching problems of CEC 2013: the global optima are where the report states them, as many, and the lowest."""

from __future__ import annotations

import numpy as np
import pytest

from tests.given.at_night import nightly_but
from tests.given.niching import ACCURACIES, PROBLEMS, SIMPLE, Niching, _constants
from worker.engine.search.base import Floats

COMPOSITIONS = list(PROBLEMS)[len(SIMPLE) :]
PERIODS = 2 * np.pi * np.arange(-1, 2)
SHUBERT = (-1.4251284281 + PERIODS, -0.8003211003 + PERIODS)
"""The coordinates of an optimum: one of each row, in either order."""


def optima(problem: Niching) -> Floats:
    """The global optima (k, n) of the unit cube as the report states them."""
    lists = {
        "F1": [[0.0], [30.0]],
        "F2": [[0.1], [0.3], [0.5], [0.7], [0.9]],
        "F3": [[0.079699392688696]],
        "F4": [[3.0, 2.0], [-2.805118, 3.131312], [-3.779310, -3.283186], [3.584428, -1.848126]],
        "F5": [[0.0898420131, -0.7126564030], [-0.0898420131, 0.7126564030]],
        "F6": [pair for a in SHUBERT[0] for b in SHUBERT[1] for pair in ([a, b], [b, a])],
        "F7": [[a, b] for a in _vincent() for b in _vincent()],
        "F10": [[(2 * i + 1) / 6, (2 * j + 1) / 8] for i in range(3) for j in range(4)],
    }
    points = np.array(lists[problem.name]) if problem.name in lists else _constants()["optima"][: problem.optima]
    return (points[:, : problem.dimension] - problem.low) / (problem.high - problem.low)


def _vincent() -> list[float]:
    return [float(np.exp((np.pi / 2 + 2 * np.pi * k) / 10)) for k in range(-2, 4)]


@pytest.mark.parametrize("name", [n for n in PROBLEMS if n not in ("F8", "F9")])
def test_all_optima_count_at_every_accuracy_and_others_do_not(name: str) -> None:
    problem = PROBLEMS[name]
    points = optima(problem)
    assert len(points) == problem.optima
    near = points + 1e-7 * np.sign(0.5 - points)  # a double of each, which does not count again
    elsewhere = np.random.default_rng(1).random((20, problem.dimension))
    for accuracy in ACCURACIES:
        assert problem.found(np.concatenate([near, points]), accuracy) == problem.optima
    assert problem.found(points[:1], 1e-5) == 1
    assert problem.found(elsewhere, 1e-5) == 0


@pytest.mark.parametrize("name", nightly_but(list(PROBLEMS)[:11], PROBLEMS))
def test_no_cost_is_below_zero(name: str) -> None:
    problem = PROBLEMS[name]
    points = np.random.default_rng(2).random((2000, problem.dimension))
    for size in (0.1, 0.01, 0.001, 0.0001):
        best = points[np.argmin(problem(points))]
        near = best + size * np.random.default_rng(3).standard_normal((500, problem.dimension))
        points = np.concatenate([points, np.clip(near, 0.0, 1.0)])
    costs = problem(points)
    assert np.isfinite(costs).all()
    assert costs.min() > -1e-8


@pytest.mark.parametrize("name", COMPOSITIONS)
def test_a_value_of_a_composition_depends_on_its_point_alone(name: str) -> None:
    problem = PROBLEMS[name]
    points = np.random.default_rng(4).random((6, problem.dimension))
    np.testing.assert_allclose(problem(points), [problem(p[None, :])[0] for p in points], rtol=1e-12)
