"""The parts of the estimate: design points, the mixture, the alarms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from campaigns.results.base import OK
from tests.bench.rare.judge import carried_out
from worker.engine.rare.alarms import alarms
from worker.engine.rare.design import cost, polished
from worker.engine.rare.evaluated import Allowance, Evaluated, Floats
from worker.engine.rare.interval import Interval
from worker.engine.rare.known import Known
from worker.engine.rare.mixture import Mixture


def corner(u: Floats) -> Floats:
    """Two conditions at once, of different scale; the nearest violation is (3, 2, 0, ...)."""
    return np.maximum(3.0 - u[:, 0], 20.0 - 10.0 * u[:, 1])


@pytest.mark.parametrize("dimension", [2, 8, 20])
def test_a_corner_is_polished_to_its_nearest_violation(dimension: int) -> None:
    start = np.full((1, dimension), 1.0)
    start[0, :2] = 7.0
    allowed = Allowance(0.0, 1000)
    (found, _), requested = carried_out(polished(start, allowed), corner)
    assert corner(found)[0] <= 0.0
    assert np.linalg.norm(found) < 1.05 * np.sqrt(13.0)
    assert requested == 1000 - allowed.left <= cost(dimension)


def test_a_curved_surface_is_polished_to_its_nearest_violation() -> None:
    (found, _), _ = carried_out(
        polished(np.array([[6.0, 2.0, -2.0]]), Allowance(0.0, 1000)), lambda u: 4.0 - u[:, 0] + 0.2 * u[:, 1] ** 2
    )
    assert found[0] == pytest.approx([4.0, 0.0, 0.0], abs=0.15)


def mixture() -> Mixture:
    """Adapted to weighted points around one of two design points."""
    start = Mixture.of(np.array([[3.0, 0.0, 0.0], [0.0, -3.5, 0.0]]))
    points = np.random.default_rng(1).normal([3.4, 0.5, 0.0], [0.3, 1.5, 1.0], (1000, 3))
    return start.adapted(points, np.linspace(1.0, 2.0, 1000))


def test_the_mixture_is_a_density_that_is_drawn_as_it_is_stated() -> None:
    """Of nominal draws the mean of the ratio is one, of its own draws that of the weights; these have a bound."""
    random = np.random.default_rng(1)
    ratio = np.exp(mixture().log_ratio(random.standard_normal((400_000, 3))))
    weights = np.exp(-mixture().log_ratio(mixture().draws(random, 100_000)))
    assert ratio.mean() == pytest.approx(1.0, abs=5.0 * ratio.std() / np.sqrt(400_000))
    assert weights.mean() == pytest.approx(1.0, abs=5.0 * weights.std() / np.sqrt(100_000))
    assert weights.max() <= 10.0


def test_adaptation_follows_the_violations() -> None:
    adapted = mixture()
    assert adapted.centres[0] == pytest.approx([3.4, 0.5, 0.0], abs=0.2)
    assert adapted.covariances[0][1, 1] > 1.5 > 0.5 > adapted.covariances[0][0, 0]
    assert adapted.shares[0] > 0.99


def raised(terms: Floats, violations: int = 0, left: int = 0, reached: Sequence[int] = (0,)) -> set[str]:
    """The alarms of an estimate of about 1e-3 with an independent sample of 300."""
    margins = np.where(np.arange(300) < violations, -1.0, 1.0)
    sample = Evaluated(np.zeros((300, 2)), margins, np.full(300, OK, dtype=np.uint8))
    k = len(reached)
    known = Known(np.ones((k, 2)), np.ones((k, 2)), np.array(reached), [[0], *[None] * (k - 1)])
    return {alarm.why for alarm in alarms(terms, Interval(1e-3, 8e-4, 1.2e-3, 0.1), sample, known, left)}


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (raised(np.ones(100)), set()),
        (raised(np.ones(100), violations=2), set()),
        (raised(np.ones(100), violations=5), {"sample"}),
        (raised(np.ones(29)), {"few"}),
        (raised(np.array([*[1.0] * 300, 100.0])), {"weight", "few"}),
        (raised(np.zeros(100)), {"few"}),
        (raised(np.ones(100), left=1), {"unexplained"}),
        (raised(np.ones(100), reached=(2, 1, 1, 1)), {"unsaturated"}),
        (raised(np.ones(100), reached=(9, 1, 1, 1)), set()),
        (raised(np.ones(100), reached=(0, 3, 4, 1)), set()),
    ],
)
def test_each_alarm_is_raised_by_its_reason(found: set[str], why: set[str]) -> None:
    assert found == why
