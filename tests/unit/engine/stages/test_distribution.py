"""The distribution function of a sample: what its band holds, and the fraction at or below values that many share."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from campaigns.asked.distributions import Correlation, Normal, Triangular
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.sample import KEPT, Distribution
from campaigns.stored.blocks import Counted, Scale
from campaigns.stored.blocks import counted as block_of
from campaigns.stored.records import Columns
from tests.given.at_night import rows_nightly_but
from tests.given.sampled_stages import asked, context
from worker.engine.problem.distributions import Distributions, Range
from worker.engine.search.base import Batch, Floats
from worker.engine.stages import certify
from worker.engine.stages.parts.claims import band
from worker.engine.stages.parts.sample import Noise, Sample
from worker.engine.stages.parts.shape import Binned, Ordered
from worker.evidence.audit import recompute
from worker.evidence.audit.distribution import Drawn

SIZE = 3000
NORMAL = Normal(mean=0.0, deviation=1.0)


def paired(low: float, high: float, correlation: float) -> Distributions:
    """Two standard normal parameters, of which the first is within these bounds."""
    ranges = [Range("v.a", 0, low, high, 0.0, NORMAL), Range("v.b", 1, -9.0, 9.0, 0.0, NORMAL)]
    return Distributions(ranges, [Correlation(between=["v.a", "v.b"], value=correlation)])


def margin(points: Floats) -> Floats:
    """Sensitive to what is redrawn: how far the two parameters are apart."""
    return np.asarray(np.abs(points[:, 0] - points[:, 1]) - 0.05 * points.sum(axis=1))


def distribution(of: Distributions, size: int = SIZE, excluded: bool = False) -> Distribution:
    points = of.quantile(np.random.default_rng(1).random((size, len(of.ranges))))
    low, high = (np.array([getattr(r, name) for r in of.ranges]) for name in ("low", "high"))
    costs, status = margin(low + points * (high - low)), np.full(size, OK, np.uint8)
    status[: size // 10 if excluded else 0] = EXCLUDED
    columns = cast(Columns, SimpleNamespace(points=points, costs=costs[:, None], status=status))
    campaign = SimpleNamespace(simulator=None)
    problem: Any = SimpleNamespace(threshold=0.0, campaign=campaign, distributions=of, system=None)
    return Sample.of(columns, problem, 0.95, Noise()).distribution()


@pytest.mark.parametrize("size", [SIZE, 100_000])
@pytest.mark.parametrize(("low", "high", "correlation"), [(-2.054, 2.054, 0.99), (-1.0, 9.0, -0.95), (-9.0, 0.5, 0.8)])
def test_the_band_holds_the_distribution_within_the_bounds_where_draws_are_redrawn(
    low: float, high: float, correlation: float, size: int
) -> None:
    found = distribution(paired(low, high, correlation), size)
    drawn = np.random.default_rng(0).multivariate_normal([0.0, 0.0], [[1.0, correlation], [correlation, 1.0]], 10**6)
    inside = np.sort(margin(drawn[(drawn[:, 0] >= low) & (drawn[:, 0] <= high)]))
    true = np.searchsorted(inside, found.values, side="right") / len(inside)
    assert np.abs(true - found.shares).max() <= found.band


def test_only_redrawn_values_make_the_band_wider() -> None:
    alone = Distributions(paired(-1.0, 1.0, 0.5).ranges)
    skewed = [Range(f"v.{k}", k, -1.0, 1.0, 0.0, Triangular(mode=0.0)) for k in range(2)]
    bounded = Distributions(skewed, [Correlation(between=["v.0", "v.1"], value=0.5)])
    for of in (alone, bounded):
        assert distribution(of).band == band(SIZE, 0.95)
        assert distribution(of, excluded=True).band == band(SIZE * 9 // 10, 0.95)
    wider = paired(-1.0, 1.0, 0.5)
    assert distribution(wider).band == pytest.approx(band(SIZE, 0.95) + 0.3173, abs=1e-4)
    assert distribution(wider, excluded=True).band == 1.0


def test_the_audit_computes_the_same_probability_of_a_redrawn_value() -> None:
    third = Range("v.c", 2, -0.5, 0.5, 0.0, NORMAL)
    of = Distributions([*paired(-1.0, 2.0, 0.5).ranges, third], [Correlation(between=["v.a", "v.b"], value=0.5)])
    uncertain = {r.path: SimpleNamespace(distribution=r.distribution) for r in of.ranges}
    correlations = [Correlation(between=["v.a", "v.b"], value=0.5), Correlation(between=["v.a", "v.c"], value=0.0)]
    campaign = SimpleNamespace(uncertain=uncertain, correlations=correlations)
    bounds = {r.path: (r.low, r.high) for r in of.ranges}
    run: Any = SimpleNamespace(campaign=campaign, bounds=bounds)
    assert recompute.Run.moved(run) == pytest.approx(of.redrawn, rel=1e-14)
    assert recompute.Run.moved(run) < recompute.Run.outside(run)


TODAY = Drawn({}, 0.95, 0.0, today=True)
"""The audit's own, by the rules of today."""


def tied(size: int, equal: int, of: Floats) -> Floats:
    """Costs of which so many are drawn from a few values."""
    generator = np.random.default_rng(7)
    return np.concatenate([generator.choice(of, equal), generator.uniform(6.0, 9.0, size - equal)])


TIES: dict[str, Callable[[int], Floats]] = {
    "a tenth has the lowest value": lambda size: tied(size, size // 10, np.array([5.0])),
    "most have the lowest value": lambda size: tied(size, size * 9 // 10, np.array([5.0])),
    "a few values": lambda size: tied(size, size, np.array([5.0, 6.0, 7.5, 9.0])),
    "a few values among others": lambda size: tied(size, size // 3, np.array([7.0, 8.0])),
    "zeros of both signs": lambda size: tied(size, size // 2, np.array([0.0, -0.0])),
    "one value": lambda size: np.full(size, 5.0),
    "no two are equal": lambda size: tied(size, 0, np.array([5.0])),
}


def holds(values: Any, shares: Any, costs: Floats) -> None:
    assert len(values) == len(shares) > 0
    assert (np.diff(values) > 0.0).all()
    assert shares == pytest.approx([(costs <= value).mean() for value in values], rel=1e-15)


@pytest.mark.parametrize("size", [1, 40, 300, KEPT, 5000])
@pytest.mark.parametrize("ties", TIES)
def test_equal_values_have_the_fraction_of_all_at_or_below(ties: str, size: int) -> None:
    costs = TIES[ties](size)
    values, ranks = Ordered(np.sort(costs)).curve()
    holds(values, np.array(ranks) / size, costs)
    again = TODAY.of_costs(np.sort(costs), 0)
    assert (again.values, again.shares) == (values, pytest.approx(np.array(ranks) / size))
    scale = Scale.over(costs[: size // 2 + 1], 1.0)
    block = block_of(0, costs[:, None], costs[:, None], np.zeros(size, np.uint8), {}, scale, 1.0)
    values, ranks = Binned(Counted.of([block], scale)).curve()
    holds(values, np.array(ranks) / size, costs)


COUNTED = [(digits, samples) for digits in (0, 1, 2, 9) for samples in (300, 2 * KEPT)]
"""Many equal values to none, of which all are stored or half."""


@pytest.mark.parametrize(("digits", "samples"), rows_nightly_but([(0, 2 * KEPT), (2, 300), (9, 2 * KEPT)], COUNTED))
def test_the_audit_finds_the_same_of_a_counted_sample(digits: int, samples: int) -> None:
    def flown(points: Floats) -> tuple[Batch, dict[int, str]]:
        costs = np.round(points.sum(axis=1), digits)[:, None]
        return Batch(costs, np.zeros(len(points), np.uint8)), {}

    of = context(asked({"certify": {"samples": samples, "keep": "lowest"}}, seed=1), flown)
    found = certify.run(of, 0).result
    columns = of.store.evaluations(0)
    assert found.blocks is not None
    assert columns is not None
    kept = np.sort(columns.costs[columns.status == OK, 0])[:KEPT]
    again = TODAY.of_blocks(found.blocks, kept)
    assert again == found.sample.distribution
