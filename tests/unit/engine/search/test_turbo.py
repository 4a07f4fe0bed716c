"""TuRBO: its process against the closed form, its region, its choice of candidates, and evaluations that fail."""

from __future__ import annotations

import math

import numpy as np
import pytest

from clearance.testing.searching import Function, run, space
from worker.engine.search.base import Floats, Method
from worker.engine.search.methods import lq_cma_es, turbo
from worker.engine.search.methods.turbo import Region, candidates, hypercube, lowest_of, method
from worker.engine.search.parts import gaussian_process
from worker.engine.search.parts.gaussian_process import fitted


def wave(x: Floats) -> Floats:
    return np.asarray(np.sin(4 * x[:, 0]) + x[:, 1] ** 2)


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.45) ** 2).sum(axis=1))


def near(x: Floats) -> Floats:
    """A cost half of whose box fails; its minimum is at a distance of 0.2 from that half."""
    return np.where(x[:, 0] > 0.5, np.nan, np.abs(x - 0.3).sum(axis=1))


def half(x: Floats) -> Floats:
    """Falls towards a plane beyond which every evaluation fails."""
    return np.where(x[:, 0] > 0.5, np.nan, (x[:, 0] - 0.9) ** 2 + ((x[:, 1:] - 0.4) ** 2).sum(axis=1))


# The process


def test_the_gradient_of_the_likelihood_is_that_of_differences() -> None:
    points = np.random.default_rng(1).random((25, 3))
    y = wave(points)
    theta, step = np.log([0.3, 0.5, 0.9, 1.1, 0.01]), 1e-6
    _, gradient = gaussian_process._likelihood(theta, points, y)
    for i in range(5):
        up, down = (gaussian_process._likelihood(theta + s * step * np.eye(5)[i], points, y)[0] for s in (1, -1))
        assert gradient[i] == pytest.approx((up - down) / (2 * step), rel=1e-5, abs=1e-7)


def test_the_likelihood_is_the_density_of_the_values() -> None:
    from scipy.stats import multivariate_normal

    points, theta = np.random.default_rng(2).random((6, 2)), np.log([0.4, 0.7, 1.3, 0.02])
    y = wave(points)
    r = math.sqrt(5) * np.linalg.norm((points[:, None] - points[None]) / [0.4, 0.7], axis=2)
    covariance = 1.3 * (1 + r + r**2 / 3) * np.exp(-r) + 0.02 * np.eye(6)
    value, _ = gaussian_process._likelihood(theta, points, y)
    density = multivariate_normal(np.zeros(6), covariance).logpdf(y)
    assert -6 * value - 3 * math.log(2 * math.pi) == pytest.approx(density, rel=1e-10)


def test_the_posterior_predicts_and_its_samples_have_its_moments() -> None:
    random = np.random.default_rng(3)
    points = random.random((40, 2))
    process = fitted(points, 7.0 + 1e6 * wave(points))
    at = random.random((50, 2))
    mean, covariance = process.posterior(at)
    assert np.abs(mean - 7.0 - 1e6 * wave(at)).max() < 0.1e6
    samples = process.sampled(at[:5], 4000, random)
    assert samples.mean(axis=0) == pytest.approx(mean[:5], abs=5 * float(np.sqrt(covariance.max() / 4000)))
    assert np.cov(samples.T) == pytest.approx(covariance[:5, :5], abs=0.15 * float(np.diag(covariance)[:5].max()))


def test_a_parameter_without_effect_gets_a_long_length_scale() -> None:
    points = np.random.default_rng(4).random((40, 3))
    lengths = fitted(points, np.sin(8 * points[:, 0])).lengths
    assert lengths[0] < 0.5 * lengths[1:].min()


@pytest.mark.parametrize(
    "values", [np.zeros(9), np.full(9, 1e100), 1e-100 * np.arange(9.0), np.array([1e11] + [0.0] * 8), np.full(9, -3.7)]
)
def test_any_finite_values_give_a_process(values: Floats) -> None:
    points = np.random.default_rng(5).random((9, 2))
    points[4] = points[3]
    process = fitted(points, values)
    assert np.isfinite(process.sampled(np.vstack([points, points[:2]]), 3, np.random.default_rng(6))).all()


# The region and its candidates


def test_the_region_grows_after_three_successes_and_halves_after_failures() -> None:
    region = Region(dimension=6, batch=2)
    assert (region.length, region.patience) == (0.8, 3)
    for _ in range(3):
        region.update(1.0, 0.5)
    assert region.length == 1.6
    region.update(1.0, 0.9995)  # an improvement below a thousandth is none
    region.update(1.0, 1.0)
    assert region.length == 1.6
    region.update(1.0, 1.0)
    assert region.length == 0.8
    assert [Region(n, q).patience for n, q in ((2, 1), (20, 1), (20, 4), (3, 100))] == [4, 20, 5, 1]


def test_the_box_follows_the_length_scales_and_stays_in_the_cube() -> None:
    low, high = Region(2, 1).box(np.array([0.5, 0.9]), np.array([0.1, 0.4]))
    assert (high - low)[0] == pytest.approx(0.4)
    assert (low[1], high[1]) == (pytest.approx(0.1), 1.0)
    near, box = np.full(30, 0.5), Region(30, 1)
    box.length = 0.2
    points = candidates(space(30, 10), near, *box.box(near, np.ones(30)))
    assert points.shape == (3000, 30)
    assert np.abs(points - 0.5).max() <= 0.1
    moved = (points != 0.5).sum(axis=1)
    assert moved.min() >= 1
    assert 19 < moved.mean() < 21


def test_no_candidate_is_chosen_twice_and_none_that_fails_if_another_succeeds() -> None:
    samples = np.tile([3.0, 1.0, 2.0, 0.0], (3, 1))
    assert lowest_of(samples, None).tolist() == [3, 1, 2]
    labels = np.tile([-1.0, -1.0, 0.5, 0.7], (3, 1))
    assert lowest_of(samples, labels).tolist() == [1, 0, 2], "when none succeeds, the one most likely to"
    assert sorted(lowest_of(np.zeros((9, 2)), None).tolist()) == [0, 1], "no more than there are"


def test_a_hypercube_has_one_point_in_every_slice() -> None:
    points = hypercube(8, space(3, 10))
    assert (np.sort(np.floor(8 * points), axis=0) == np.arange(8)[:, None]).all()


# The search


def test_it_begins_with_a_hypercube_then_asks_for_batches_of_the_given_size() -> None:
    found = run(method, bowl, 3, 30, options={"batch": 5})
    assert list(map(len, found.batches)) == [6, 5, 5, 5, 5, 5]
    assert found.lowest < 0.3 * float(bowl(found.batches[0]).min())


def test_it_restarts_when_the_region_is_small_and_reports_where() -> None:
    found = run(method, lambda x: np.zeros(len(x)), 1, 60)
    assert found.minima[0].text == "the trust region became small"
    assert list(map(len, found.batches))[:9] == [2, 4, 4, 4, 4, 4, 4, 4, 2], "0.8 is halved seven times"


def test_without_a_value_it_draws_other_hypercubes() -> None:
    found = run(method, lambda x: np.full(len(x), np.nan), 2, 40)
    assert list(map(len, found.batches)) == [4] * 10
    assert len(np.unique(found.points, axis=0)) == 40
    assert found.minima == []


@pytest.mark.parametrize(
    ("function", "less"),
    [(near, 0.5), pytest.param(half, 0.9, marks=pytest.mark.nightly)],
    ids=["aside", "at the edge"],
)
def test_it_avoids_what_fails(function: Function, less: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without its model of the labels, more evaluations fail: most where the cost falls towards the failing half."""

    def failed() -> float:
        counts = [np.isnan(np.concatenate(run(method, function, 3, 46, seed=s).values)[6:]) for s in (1, 2)]
        return float(np.mean(np.concatenate(counts)))

    knowing = failed()
    choose = lowest_of
    monkeypatch.setattr(turbo, "lowest_of", lambda samples, labels: choose(samples, None))
    assert knowing < less * failed()


def test_a_cost_in_other_units_gives_the_same_search() -> None:
    """Scaled by a power of two, the standardised values have the same bits."""
    one, two = run(method, bowl, 2, 30), run(method, lambda x: 1024 * bowl(x), 2, 30)
    assert np.array_equal(one.points, two.points)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: 1e300 * np.sign(x[:, 0] - 0.5),
        lambda x: np.where(x[:, 0] > 0.5, 1.7e308, x[:, 0]),
        lambda x: np.full(len(x), -1.7e308),
        lambda x: 5e-324 * np.floor(9 * x[:, 0]),
        lambda x: 1e9 + 1e-8 * x[:, 0],
        lambda x: np.where(np.abs(x - 0.5).max(axis=1) < 0.1, 1e200 * np.tan(1e6 * x[:, 0]), np.nan),
    ],
    ids=["signs", "cliff", "constant", "tiny", "rounding", "spikes"],
)
@pytest.mark.parametrize("searched", [method, lq_cma_es.method], ids=lambda m: m.name)
def test_costs_of_any_size_are_survived_without_a_warning(searched: Method, function: Function) -> None:
    found = run(searched, function, 2, 24)
    assert np.isfinite(found.points).all()
    assert len(found.points) >= 24


def test_its_process_has_a_limited_number_of_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(turbo, "MOST", 12)
    sizes: list[int] = []

    def note(points: Floats, *rest: object) -> object:
        sizes.append(len(points))
        return fitted(points, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(turbo, "fitted", note)
    run(method, half, 2, 40)
    assert max(sizes) == 12
