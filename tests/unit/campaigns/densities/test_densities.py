"""Densities of a campaign's distributions: against SciPy, and against the draws that runs make."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import special as scipy_special
from scipy import stats

from campaigns import special
from campaigns.asked.distributions import Beta, Distribution, Normal, Triangular, TruncatedNormal, Uniform
from campaigns.densities.shapes import shape
from tests.given.stated_densities import HIGH, LOW, drawn, made

UNIFORM = np.random.default_rng(11).random(100_000)

KINDS: dict[str, tuple[Distribution, stats.rv_continuous]] = {
    "uniform": (Uniform(), stats.uniform(4, 2)),
    "practically uniform": (Normal(mean=5.5, deviation=1e9), stats.uniform(4, 2)),
    "triangular": (Triangular(mode=5.5), stats.triang(0.75, 4, 2)),
    "triangular to a bound": (Triangular(mode=6.0), stats.triang(1.0, 4, 2)),
    "truncated normal": (TruncatedNormal(mean=5.5, deviation=0.5), stats.truncnorm(-3, 1, 5.5, 0.5)),
    "normal within the bounds": (Normal(mean=5.5, deviation=0.5), stats.truncnorm(-3, 1, 5.5, 0.5)),
    "beta": (Beta(alpha=2.0, beta=5.0), stats.beta(2, 5, 4, 2)),
    "beta of two heaps": (Beta(alpha=0.5, beta=0.5), stats.beta(0.5, 0.5, 4, 2)),
    "beta from a bound": (Beta(alpha=1.0, beta=3.0), stats.beta(1, 3, 4, 2)),
}


@pytest.mark.parametrize("name", KINDS)
def test_density_and_probability_of_each_distribution(name: str) -> None:
    kind, expected = KINDS[name]
    one, u = shape(kind, LOW, HIGH), np.linspace(0.001, 0.999, 999)
    at = LOW + (HIGH - LOW) * u
    assert np.exp(one.log_density(u)) / (HIGH - LOW) == pytest.approx(expected.pdf(at), rel=1e-9)
    assert one.below(u) == pytest.approx(expected.cdf(at), rel=1e-9)
    assert one.score(u) == pytest.approx(
        (at - 5.5) / 0.5 if name.startswith("normal") else stats.norm.ppf(expected.cdf(at)), rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize("name", [n for n in KINDS if "uniform" not in n and "heaps" not in n])
def test_the_probability_of_a_lower_density_is_that_of_draws(name: str) -> None:
    kind, expected = KINDS[name]
    one = shape(kind, LOW, HIGH)
    falls = one.fall((expected.ppf(UNIFORM) - LOW) / (HIGH - LOW))
    for q in (0.1, 1.0, 3.0):
        fraction = float(one.beyond(np.array([q]))[0])
        assert float((falls > q).mean()) == pytest.approx(fraction, abs=4 * np.sqrt(0.25 / len(UNIFORM)))


@pytest.mark.parametrize(("a", "b"), [(2, 3), (0.5, 0.7), (1, 4), (300, 20.5), (1e5, 2e5), (3.3, 0.2)])
def test_special_functions_are_those_of_scipy(a: float, b: float) -> None:
    x = np.concatenate([np.linspace(0, 1, 41), a / (a + b) + np.linspace(-1e-3, 1e-3, 21)])
    assert special.beta(x, a, b) == pytest.approx(scipy_special.betainc(a, b, x), rel=1e-9, abs=1e-14)
    assert special.beta_quantile(0.025, a, b) == pytest.approx(scipy_special.betaincinv(a, b, 0.025), rel=1e-9)
    q = np.linspace(0, 60, 50)
    for freedom in range(1, 12):
        assert special.chi_square_beyond(q, freedom) == pytest.approx(stats.chi2.sf(q, freedom), rel=1e-12)


@pytest.mark.parametrize("correlation", [-0.7, 0.8])
def test_correlated_normals_have_the_density_of_the_normal_distribution(correlation: float) -> None:
    kinds = Normal(mean=5.0, deviation=0.1), Normal(mean=5.2, deviation=0.05)
    points = drawn(*kinds, correlation=correlation, count=50)
    at = LOW + (HIGH - LOW) * points
    spread = np.outer([0.1, 0.05], [0.1, 0.05]) * [[1, correlation], [correlation, 1]]
    expected = stats.multivariate_normal([5.0, 5.2], spread).logpdf(at) + 2 * np.log(HIGH - LOW)
    assert made(*kinds, correlation=correlation).log_density(points) == pytest.approx(expected, rel=1e-9)


def test_correlated_densities_of_any_kind_integrate_to_one() -> None:
    kinds = Triangular(mode=5.5), Beta(alpha=2.0, beta=3.0)
    of = made(*kinds, correlation=0.6)
    axis = (np.arange(400) + 0.5) / 400
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    density = np.exp(of.log_density(grid))
    assert density.mean() == pytest.approx(1.0, abs=2e-3)
    inside = (grid < 0.5).all(axis=1)
    assert density[inside].mean() * 0.25 == pytest.approx(
        (drawn(*kinds, correlation=0.6) < 0.5).all(axis=1).mean(), abs=6e-3
    )
