"""A campaign as a problem: exact bounds, distributions, every parameter may vary."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, case1, searching
from worker.engine.stages.parts.context import Context
from worker.running.runs.store import MemoryStore


@pytest.mark.parametrize(
    ("distribution", "cdf"),
    [
        ({"kind": "uniform"}, stats.uniform(4, 2).cdf),
        ({"kind": "triangular", "mode": 5.5}, stats.triang(0.75, 4, 2).cdf),
        ({"kind": "triangular", "mode": 4.0}, stats.triang(0.0, 4, 2).cdf),
        ({"kind": "truncated_normal", "mean": 5.5, "deviation": 0.5}, stats.truncnorm(-3, 1, 5.5, 0.5).cdf),
    ],
)
def test_samples_follow_their_distribution(distribution: dict[str, Any], cdf: Any) -> None:
    problem = Problem(campaign(**{"uncertain__vehicle.m": {"low": 4, "high": 6, "distribution": distribution}}))
    points = problem.quantile(np.random.default_rng(1).random((2000, 2)))
    assert stats.kstest(problem.values(points)[:, 0], cdf).pvalue > 0.01
    assert stats.kstest(points[:, 1], "uniform").pvalue > 0.01


@pytest.mark.parametrize("deviation", [1e-12, 1e-6, 1.0, 1e3, 1e5, 2e5, 1e8, 1e12])
@pytest.mark.parametrize("bounds", [(4.0, 6.0), (5.0, 5.000001)])
def test_any_normal_distribution_gives_points_inside(deviation: float, bounds: tuple[float, float]) -> None:
    low, high = bounds
    given = {
        "low": low,
        "high": high,
        "distribution": {"kind": "truncated_normal", "mean": 5.0, "deviation": deviation},
    }
    changes: dict[str, Any] = {"uncertain__vehicle.m": given}
    problem = Problem(searching({"method": "direct", "evaluations": 1}, **changes))
    points = problem.quantile(np.linspace(0, 1, 101, endpoint=False)[:, None] * [1.0, 1.0])
    assert np.isfinite(points).all()
    assert points.min() >= 0
    assert points.max() <= 1
    assert (np.diff(points[:, 0]) >= 0).all()
    if deviation > 1e3:
        assert points[:, 0] == pytest.approx(np.linspace(0, 1, 101, endpoint=False), abs=1e-3)


KINDS: dict[str, dict[str, Any]] = {
    "uniform": {"kind": "uniform"},
    "triangular": {"kind": "triangular", "mode": 5.5},
    "truncated normal": {"kind": "truncated_normal", "mean": 5.5, "deviation": 0.5},
    "flat": {"kind": "truncated_normal", "mean": 5.5, "deviation": 1e6},
    "normal": {"kind": "normal", "mean": 5.1, "deviation": 0.4},
    "beta": {"kind": "beta", "alpha": 2.0, "beta": 5.0},
}


@pytest.mark.parametrize("value", [0.0, 0.7, -0.95])
@pytest.mark.parametrize("kind", KINDS)
def test_uniform_is_the_inverse_of_quantile(kind: str, value: float) -> None:
    """With a correlated normal only where no value was redrawn within the bounds, which `estimate` refuses."""
    given = {"low": 4, "high": 6, "distribution": KINDS[kind]}
    pair = [{"between": ["vehicle.m", "vehicle.J"], "value": value}]
    of = Problem(campaign(**{"uncertain__vehicle.m": given, "correlations": pair})).distributions
    uniform = np.random.default_rng(2).random((500, 2))
    uniform[:4] = [[1e-9, 0.5], [1 - 1e-9, 0.5], [0.5, 1e-9], [1e-6, 1 - 1e-6]]
    if kind == "normal" and value:
        uniform = uniform[np.abs(uniform[:, 0] - 0.5) < 0.45]
    back = of.uniform(of.quantile(uniform))
    assert back == pytest.approx(uniform, rel=1e-6, abs=1e-12)
    points = of.quantile(uniform)
    assert of.quantile(back) == pytest.approx(points, abs=1e-9)


# Problem


def test_bounds_and_nominal_values_are_exact() -> None:
    problem = case1()
    points = np.array([[0.0, 0.0], [1.0, 1.0], problem.nominal_point])
    assert problem.values(points).tolist() == [[4.0, 0.04], [6.0, 0.06], [5.0, 0.05]]
    assert problem.named(problem.point({"vehicle.m": 4.5})) == {"vehicle.m": 4.5, "vehicle.J": 0.05}


def test_every_parameter_may_be_uncertain() -> None:
    paths = {path: index for path, index in case1().paths.items() if path != "criterion.threshold"}
    for path in paths:
        nominal = float(case1().system.nominal[paths[path]])
        bounds = {"low": nominal, "high": nominal + 0.01 * max(nominal, 1.0)}
        problem = Problem(searching({"method": "direct", "evaluations": 1}, uncertain={path: bounds}))
        vector = problem.vectors(np.array([[1.0]]))[0]
        assert np.flatnonzero(vector != problem.system.nominal).tolist() == [paths[path]]


def test_a_context_of_nothing_has_nothing() -> None:
    made = Context(campaign(), case1(), case1().evaluate, MemoryStore())
    assert (made.columns, made.results) == ({}, {})
    assert made.cancelled() is False
