"""Distributions and correlations: marginals against SciPy, the copula against the normal distribution it comes from."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns import CampaignError, check
from campaigns.asked.distributions import (
    Beta,
    Correlation,
    Distribution,
    Normal,
    Triangular,
    TruncatedNormal,
    Uniform,
    matrix,
)
from campaigns.checked.uncertainty import positive_definite
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from worker.engine.problem.distributions import Distributions, Floats, Range
from worker.running.catalogue.installed import catalogue

LOW, HIGH = 4.0, 6.0


def made(*kinds: Distribution, correlations: dict[tuple[int, int], float] | None = None) -> Distributions:
    """Parameters a.0, a.1, ... within 4 to 6."""
    ranges = [Range(f"a.{k}", k, LOW, HIGH, 5.0, kind) for k, kind in enumerate(kinds)]
    pairs = [Correlation(between=[f"a.{i}", f"a.{k}"], value=v) for (i, k), v in (correlations or {}).items()]
    return Distributions(ranges, pairs)


def drawn(distributions: Distributions, count: int = 4000, seed: int = 1) -> Floats:
    """Points in the parameters' units."""
    uniform = np.random.default_rng(seed).random((count, len(distributions.ranges)))
    return LOW + distributions.quantile(uniform) * (HIGH - LOW)


KINDS: dict[str, tuple[Distribution, Any]] = {
    "uniform": (Uniform(), stats.uniform(4, 2)),
    "triangular": (Triangular(mode=5.5), stats.triang(0.75, 4, 2)),
    "truncated normal": (TruncatedNormal(mean=5.5, deviation=0.5), stats.truncnorm(-3, 1, 5.5, 0.5)),
    "normal, of which the inside is drawn": (Normal(mean=5.5, deviation=0.5), stats.truncnorm(-3, 1, 5.5, 0.5)),
    "beta": (Beta(alpha=2.0, beta=5.0), stats.beta(2, 5, 4, 2)),
    "beta of two heaps": (Beta(alpha=0.5, beta=0.5), stats.beta(0.5, 0.5, 4, 2)),
}


@pytest.mark.parametrize("name", KINDS)
def test_quantiles_are_those_of_scipy(name: str) -> None:
    kind, expected = KINDS[name]
    uniform = np.linspace(0.001, 0.999, 999)[:, None]
    points = LOW + made(kind).quantile(uniform) * (HIGH - LOW)
    assert points[:, 0] == pytest.approx(expected.ppf(uniform[:, 0]), abs=1e-9)


@pytest.mark.parametrize("name", KINDS)
def test_marginals_stay_what_they_are_under_correlation(name: str) -> None:
    kind, expected = KINDS[name]
    points = drawn(made(kind, Uniform(), correlations={(0, 1): 0.8}))
    assert stats.kstest(points[:, 0], expected.cdf).pvalue > 0.01
    assert stats.kstest(points[:, 1], stats.uniform(4, 2).cdf).pvalue > 0.01


@pytest.mark.parametrize("value", [-0.9, -0.3, 0.6])
def test_the_rank_correlation_of_the_copula(value: float) -> None:
    # Spearman's coefficient of a Gaussian copula is 6/pi asin(rho/2) (Kruskal 1958).
    points = drawn(made(Beta(alpha=2, beta=5), Triangular(mode=4), correlations={(0, 1): value}), 20_000)
    found = stats.spearmanr(points[:, 0], points[:, 1]).statistic
    assert found == pytest.approx(6 / np.pi * np.arcsin(value / 2), abs=0.015)


def test_three_at_once_and_one_that_is_left_alone() -> None:
    given = {(0, 1): 0.7, (1, 3): -0.4, (0, 3): 0.1}
    wide = Normal(mean=5.0, deviation=0.1)
    distributions = made(wide, wide, Uniform(), wide, correlations=given)
    uniform = np.random.default_rng(3).random((20_000, 4))
    points = distributions.quantile(uniform)
    assert np.array_equal(points[:, 2], uniform[:, 2])
    found = np.corrcoef(points.T)
    for (i, k), value in given.items():
        assert found[i, k] == pytest.approx(value, abs=0.02)


def test_no_correlation_changes_no_number() -> None:
    uniform = np.random.default_rng(1).random((50, 2))
    assert np.array_equal(made(Uniform(), Uniform()).quantile(uniform), uniform)
    assert np.array_equal(made(Uniform(), Uniform(), correlations={(0, 1): 0.0}).quantile(uniform), uniform)


def test_points_inside_are_those_of_the_unbounded_normal_distribution() -> None:
    kinds = (Normal(mean=5.0, deviation=0.8), Normal(mean=4.5, deviation=0.6))
    distributions = made(*kinds, correlations={(0, 1): 0.7})
    uniform = np.random.default_rng(5).random((20_000, 2))
    normal = stats.norm.ppf(uniform)
    second = 0.7 * normal[:, 0] + np.sqrt(1 - 0.49) * normal[:, 1]
    unbounded = np.column_stack([5.0 + 0.8 * normal[:, 0], 4.5 + 0.6 * second])
    inside = ((unbounded >= LOW) & (unbounded <= HIGH)).all(axis=1)
    points = LOW + distributions.quantile(uniform) * (HIGH - LOW)
    assert points[inside] == pytest.approx(unbounded[inside], abs=1e-9)
    assert ((points >= LOW) & (points <= HIGH)).all()
    # The tails are bounded by the sum, for any correlation.
    assert (~inside).mean() <= distributions.outside == pytest.approx(0.2113 + 0.2085, abs=1e-3)
    # A value that fell beyond is drawn again within: the marginal stays the one within the bounds.
    expected = stats.truncnorm(-1.25, 1.25, 5.0, 0.8)
    assert stats.kstest(points[:, 0], expected.cdf).pvalue > 0.01


def test_the_probability_beyond_the_bounds() -> None:
    one = Normal(mean=5.0, deviation=0.5)  # two standard deviations on each side
    tails = 2 * stats.norm.sf(2)
    assert made(one).outside == pytest.approx(tails)
    assert made(one, one).outside == pytest.approx(1 - (1 - tails) ** 2)
    assert made(one, one, correlations={(0, 1): 0.5}).outside == pytest.approx(2 * tails)
    assert made(one, Uniform(), Uniform(), correlations={(1, 2): 0.5}).outside == pytest.approx(tails)
    assert made(Uniform(), TruncatedNormal(mean=5, deviation=9), Beta(alpha=1, beta=1)).outside == 0.0
    far = Normal(mean=5.0, deviation=1e6)
    assert made(far, far, correlations={(0, 1): 0.5}).outside == 1.0


@pytest.mark.parametrize("value", [0.0, 0.999999])
@pytest.mark.parametrize("deviation", [1e-12, 1e-3, 1.0, 1e5, 1e12])
def test_any_number_gives_points_inside(deviation: float, value: float) -> None:
    normal = Normal(mean=4.0, deviation=deviation)
    distributions = made(normal, Beta(alpha=0.01, beta=1e6), Beta(alpha=1e6, beta=0.01), correlations={(0, 1): value})
    uniform = np.array([[0.0] * 3, [1e-320] * 3, [0.5] * 3, [1 - 2**-53] * 3, [0.0, 1 - 2**-53, 0.5]])
    points = distributions.quantile(uniform)
    assert np.isfinite(points).all()
    assert points.min() >= 0.0
    assert points.max() <= 1.0


def test_marginals_leave_correlations_out() -> None:
    uniform = np.random.default_rng(1).random((50, 2))
    assert np.array_equal(made(Uniform(), Uniform(), correlations={(0, 1): 0.9}).marginals(uniform), uniform)


# Campaigns


def correlated(*given: tuple[str, str, float], **changes: Any) -> dict[str, Any]:
    return {"correlations": [{"between": [a, b], "value": v} for a, b, v in given], **changes}


THREE = {
    "vehicle.m": {"low": 4, "high": 6},
    "vehicle.J": {"low": 0.04, "high": 0.06},
    "avoider.k_rep": {"plus_minus": 1},
}

FAR = {"low": 4, "high": 6, "distribution": {"kind": "normal", "mean": 7, "deviation": 1}}


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        (
            correlated(("vehicle.m", "vehicle.JJ", 0.5)),
            "correlations.0.between", "not an uncertain parameter; did you mean 'vehicle.J'?",
        ),
        (
            correlated(("vehicle.m", "vehicle.m", 0.5)),
            "correlations.0.between", "a parameter cannot be correlated with itself; name two different parameters",
        ),
        (
            correlated(("vehicle.m", "vehicle.J", 0.5), ("vehicle.J", "vehicle.m", 0.2)),
            "correlations.1.between", "this pair is already given as correlations.0",
        ),
        (
            correlated(
                ("vehicle.m", "vehicle.J", 0.9), ("vehicle.m", "avoider.k_rep", 0.9),
                ("vehicle.J", "avoider.k_rep", -0.9), uncertain=THREE,
            ),
            "correlations",
            "the correlation matrix is not positive definite; reduce the magnitude of some correlations",
        ),
        (
            {"uncertain__vehicle.m": FAR},
            "uncertain.vehicle.m.distribution.mean", "must be within 4 to 6",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_campaign(changes: dict[str, Any], field: str, message: str) -> None:
    (problem,) = check(campaign(**changes), catalogue())
    assert (problem.field, problem.message) == (field, message)


@pytest.mark.parametrize("value", [-1, 1, 1.5])
def test_a_correlation_lies_between_minus_one_and_one(value: float) -> None:
    with pytest.raises(CampaignError, match=r"correlations\.0\.value"):
        campaign(**correlated(("vehicle.m", "vehicle.J", value)))


def test_a_campaign_with_correlations() -> None:
    one = campaign(**correlated(("vehicle.m", "vehicle.J", 0.6)))
    assert one.digest == campaign(**correlated(("vehicle.J", "vehicle.m", 0.6))).digest != campaign().digest
    assert check(one, catalogue()) == []
    points = Problem(one).quantile(np.random.default_rng(1).random((4000, 2)))
    assert np.corrcoef(points.T)[0, 1] == pytest.approx(6 / np.pi * np.arcsin(0.3), abs=0.03)


@pytest.mark.parametrize("seed", range(5))
def test_positive_definite_as_the_eigenvalues_say(seed: int) -> None:
    chance = np.random.default_rng(seed)
    paths = [f"a.{k}" for k in range(5)]
    pairs = [
        Correlation(between=[paths[i], paths[k]], value=float(chance.uniform(-0.7, 0.7)))
        for i in range(5)
        for k in range(i)
    ]
    rows = matrix(pairs, paths)
    assert positive_definite(rows) == (np.linalg.eigvalsh(np.array(rows)).min() > 1e-9)
