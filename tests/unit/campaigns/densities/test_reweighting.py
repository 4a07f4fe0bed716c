"""Estimates under moved distributions: closed forms, how often the interval holds, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns.asked.distributions import Beta, Correlation, Distribution, Normal, Triangular, TruncatedNormal, Uniform
from campaigns.claims import reweighted as claims
from campaigns.claims.spans import values
from campaigns.densities.joint import Joint, joined
from campaigns.densities.reweighting import NEEDED, Drawn, Terms, reweighted
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.reweighted import Reweighted
from tests.given.at_night import nightly_but
from tests.given.stated_densities import drawn, made

SHARES = (0.05, 0.5)


def over(kind: Distribution, low: float = 4.0, high: float = 6.0) -> Joint:
    return joined({"a.0": kind}, [], {"a.0": (low, high)})


def sample(points: np.ndarray, costs: np.ndarray, status: Any = OK) -> Drawn:
    return Drawn(points, costs, np.broadcast_to(np.array(status, np.uint8), len(costs)))


def from_first(kind: Distribution, moved: Joint, threshold: float, count: int, seed: int) -> Reweighted:
    """Of a criterion that is the value of the only parameter."""
    points = drawn(kind, count=count, seed=seed)
    return reweighted(over(kind), moved, sample(points, 4.0 + 2.0 * points[:, 0]), Terms(threshold, 0.95, SHARES))


def test_unmoved_distributions_give_the_fraction_and_its_interval() -> None:
    kind = Normal(mean=5.0, deviation=0.2)
    found = from_first(kind, over(kind), 4.8, 1000, 1)
    k = found.violations
    assert (found.samples, found.effective, found.probability) == (1000, pytest.approx(1000.0), pytest.approx(k / 1000))
    assert found.low == pytest.approx(stats.beta.ppf(0.025, k, 1001 - k), rel=1e-6)
    assert found.high == pytest.approx(stats.beta.ppf(0.975, k + 1, 1000 - k), abs=2 * found.outside)
    assert values(found.statement) == {
        "probability": found.probability, "low": found.low, "high": found.high, "confidence": 0.95,
        "samples": 1000.0, "outside": found.outside, "effective": 1000.0,
    }  # fmt: skip


CASES: dict[str, tuple[Distribution, Distribution, tuple[float, float], float, float, int]] = {
    "a shift towards the violations": (
        *(Normal(mean=5.0, deviation=0.2), Normal(mean=4.8, deviation=0.2), (4.0, 6.0)),
        *(4.6, stats.norm.cdf(-1.0), 1000),
    ),
    "a shift away from them": (
        *(Normal(mean=5.0, deviation=0.2), Normal(mean=5.2, deviation=0.2), (4.0, 6.0)),
        *(4.6, stats.norm.cdf(-3.0), 1000),
    ),
    "a wider one, whose violations are rare in the sample": (
        *(Normal(mean=5.0, deviation=0.2), Normal(mean=5.0, deviation=0.26), (4.0, 6.0)),
        *(4.4, stats.norm.cdf(-0.6 / 0.26), 1000),
    ),
    "a triangle made uniform, whose violations are rare in the sample": (
        *(Triangular(mode=5.0), Uniform(), (4.0, 6.0), 4.02, 0.01, 3000),
    ),
    "a narrower box": (Uniform(), Uniform(), (4.0, 4.6), 4.1, 1 / 6, 1000),
    "a box made normal": (
        *(Uniform(), TruncatedNormal(mean=4.4, deviation=0.2), (4.0, 6.0)),
        *(4.1, stats.truncnorm(-2, 8, 4.4, 0.2).cdf(4.1), 1000),
    ),
    "another shape": (
        *(Beta(alpha=2.0, beta=4.0), Beta(alpha=2.0, beta=5.0), (4.0, 6.0)),
        *(4.2, stats.beta(2, 5, 4, 2).cdf(4.2), 1000),
    ),
}


BY_DAY = ("a shift away from them", "a box made normal")


@pytest.mark.parametrize("name", nightly_but(BY_DAY, CASES))
def test_the_interval_holds_the_exact_probability(name: str) -> None:
    stated, moved, bounds, threshold, exact, count = CASES[name]
    found = [from_first(stated, over(moved, *bounds), threshold, count, seed) for seed in range(100)]
    estimates = [f for f in found if f.low is not None and f.high is not None]
    assert len(estimates) > 95
    held = sum(f.low <= exact <= f.high for f in estimates)
    assert held >= 0.93 * len(estimates)
    assert np.mean([f.probability for f in estimates]) == pytest.approx(exact, rel=0.2)


def test_quantiles_are_those_of_the_moved_distribution() -> None:
    found = from_first(Normal(mean=5.0, deviation=0.2), over(Normal(mean=5.1, deviation=0.2)), 4.0, 4000, 3)
    exact = stats.norm.ppf(SHARES, 5.1, 0.2)
    assert [q.value for q in found.quantiles] == pytest.approx(exact, abs=0.02)
    few = from_first(Normal(mean=5.0, deviation=0.2), over(Normal(mean=4.9, deviation=0.2)), 4.0, 200, 3)
    assert [q.value is None for q in few.quantiles] == [True, False]


def test_correlated_normals_keep_their_correlation() -> None:
    kinds = Normal(mean=5.0, deviation=0.15), Normal(mean=5.0, deviation=0.15)
    points = drawn(*kinds, correlation=0.6, count=20_000)
    moved = made(Normal(mean=5.1, deviation=0.15), kinds[1], correlation=0.6)
    costs = (4.0 + 2.0 * points).sum(axis=1)
    found = reweighted(made(*kinds, correlation=0.6), moved, sample(points, costs), Terms(9.8, 0.95, ()))
    assert found.probability == pytest.approx(stats.norm.cdf(9.8, 10.1, 0.15 * np.sqrt(3.2)), rel=0.05)


def test_failed_draws_violate_and_excluded_ones_are_left_out() -> None:
    kind, moved = TruncatedNormal(mean=5.0, deviation=0.4), over(TruncatedNormal(mean=5.1, deviation=0.4))
    points = drawn(kind, count=20_000)
    x = 4.0 + 2.0 * points[:, 0]
    status = np.where(x < 4.5, FAILED, np.where(x > 5.5, EXCLUDED, OK))
    costs = np.where(status == OK, x, np.nan)
    found = reweighted(over(kind), moved, sample(points, costs, status), Terms(4.7, 0.95, (0.01,)))
    exact = stats.truncnorm(-1.1 / 0.4, 0.9 / 0.4, 5.1, 0.4)
    assert (found.failed, found.excluded) == (np.count_nonzero(status == FAILED), np.count_nonzero(status == EXCLUDED))
    assert found.samples == 20_000 - found.excluded
    assert found.probability == pytest.approx(exact.cdf(4.7) / exact.cdf(5.5), rel=0.05)
    assert found.quantiles[0].value is None


def test_what_is_beyond_the_bounds_counts_relative_to_what_is_not_excluded() -> None:
    """Half of the draws are excluded; of those beyond the bounds all may violate, and none may be excluded."""
    kind = Normal(mean=5.0, deviation=0.4)
    points = drawn(kind, count=20_000)
    x = 4.0 + 2.0 * points[:, 0]
    status = np.where(x > 5.0, EXCLUDED, OK)
    terms = Terms(4.05, 0.95, ())
    found = reweighted(over(kind), over(kind), sample(points, np.where(status == OK, x, np.nan), status), terms)
    assert found.high is not None
    assert found.probability is not None
    kept = (1.0 - found.outside) / 2.0
    for probability in (found.probability, 0.0):
        assert found.high > (kept * probability + found.outside) / (kept + found.outside)
    assert values(found.statement)["outside"] == pytest.approx(2.0 * found.outside, rel=0.05)


def test_an_estimate_that_cannot_be_made_is_refused() -> None:
    kind = Normal(mean=5.0, deviation=0.2)
    far = from_first(kind, over(Normal(mean=5.4, deviation=0.2)), 4.6, 1000, 1)
    assert (far.probability, far.low, far.high, far.quantiles) == (None, None, None, [])
    assert far.effective < NEEDED
    assert far.statement == claims.too_few(far.effective, 1000, NEEDED)
    small = from_first(kind, over(kind), 4.6, NEEDED - 1, 1)
    assert small.statement == claims.too_few(NEEDED - 1, NEEDED - 1, NEEDED)
    beyond = from_first(kind, over(Normal(mean=5.7, deviation=0.2)), 4.6, 1000, 1)
    assert beyond.statement == claims.outside(beyond.outside, 0.05)
    wider = from_first(kind, over(kind, 3.9, 6.0), 4.6, 1000, 1)
    assert wider.statement == claims.beyond(["a.0"])
    pair = made(Normal(mean=5.0, deviation=0.4), Normal(mean=5.0, deviation=0.4), correlation=0.5)
    points = drawn(Normal(mean=5.0, deviation=0.4), Normal(mean=5.0, deviation=0.4), correlation=0.5, count=1000)
    again = reweighted(pair, pair, sample(points, points[:, 0]), Terms(0.1, 0.95, ()))
    assert again.statement == claims.redrawn(pair.outside)
    assert pair.outside == pytest.approx(4 * stats.norm.cdf(-2.5))


def test_weights_that_the_draws_do_not_show_count() -> None:
    """A shift by two deviations: the draws seem to be worth a hundred, and are worth 1000 exp(-4)."""
    kind, moved = Normal(mean=5.0, deviation=0.1), over(Normal(mean=5.2, deviation=0.1))
    found = [from_first(kind, moved, 4.0, 1000, seed).effective for seed in range(20)]
    assert max(found) < 1.3 * 1000 * np.exp(-4.0)


def test_a_pair_that_is_not_correlated_is_not_redrawn() -> None:
    pairs = [Correlation(between=["a.0", "a.1"], value=0.0)]
    kind = Normal(mean=5.0, deviation=0.4)
    free = joined({"a.0": kind, "a.1": kind}, pairs, {"a.0": (4.0, 6.0), "a.1": (4.0, 6.0)})
    assert free.mixed == ()
    assert free.outside == pytest.approx(1.0 - (1.0 - 2 * stats.norm.cdf(-2.5)) ** 2)
