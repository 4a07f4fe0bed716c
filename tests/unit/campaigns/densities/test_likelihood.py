"""How likely a case is: closed forms of normal distributions, draws of all others, and what is refused."""

from __future__ import annotations

from itertools import cycle, product
from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns.asked.distributions import Beta, Correlation, Distribution, Normal, Triangular, TruncatedNormal, Uniform
from campaigns.claims import likelihood as claims
from campaigns.claims.spans import values
from campaigns.densities.joint import joined
from campaigns.densities.likelihood import Rows, likelihood, most_likely
from campaigns.results.base import EXCLUDED, FAILED, OK
from tests.given.at_night import rows_nightly_but
from tests.given.stated_densities import drawn, made

BELL = Normal(mean=5.0, deviation=0.1)
NUMBERS = ("density", "distance", "tail")
SIGMA = 0.05
"""The deviation as a fraction of the range."""


def test_a_normal_point_is_as_far_as_its_standard_deviations() -> None:
    found = likelihood(made(BELL, BELL, BELL), 0.5 + SIGMA * np.array([1.0, -2.0, 2.0]))
    assert found.distance == pytest.approx(3.0)
    assert found.density == pytest.approx(np.exp(-4.5))
    assert found.tail == pytest.approx(stats.chi2.sf(9.0, 3))
    assert found.parameters == 3
    stated = {"distance": found.distance, "density": found.density, "tail": found.tail}
    assert values(found.statement) == stated
    assert [number in found.text for number in ("3 standard deviations", "1.11 %", "2.93 %")] == [True] * 3


def test_a_correlated_normal_point_has_its_mahalanobis_distance() -> None:
    found = likelihood(made(BELL, BELL, correlation=0.8), 0.5 + SIGMA * np.array([1.0, 1.0]))
    assert found.distance == pytest.approx(np.sqrt(2 / 1.8))
    against = likelihood(made(BELL, BELL, correlation=0.8), 0.5 + SIGMA * np.array([1.0, -1.0]))
    assert against.distance == pytest.approx(np.sqrt(2 / 0.2))


def test_uniform_parameters_do_not_count_and_units_change_nothing() -> None:
    plain, other = made(BELL), made(BELL, Uniform(), Uniform())
    one, more = likelihood(plain, np.array([0.6])), likelihood(other, np.array([0.6, 0.0, 1.0]))
    assert (one.density, one.distance, one.tail) == (more.density, more.distance, more.tail)
    assert "without the 2 uniform; " in more.text
    in_other_units = joined({"a": Normal(mean=5000.0, deviation=100.0)}, [], {"a": (4000.0, 6000.0)})
    assert likelihood(in_other_units, in_other_units.point({"a": 5200.0})).distance == pytest.approx(one.distance)


@pytest.mark.parametrize(
    "kinds",
    [
        (TruncatedNormal(mean=5.2, deviation=0.6), Triangular(mode=4.5)),
        (TruncatedNormal(mean=5.2, deviation=0.6), Beta(alpha=2.5, beta=4.0), Uniform()),
        (Triangular(mode=4.0), Triangular(mode=5.0), Beta(alpha=1.0, beta=3.0), BELL),
    ],
)
@pytest.mark.parametrize("at", [0.35, 0.2])
def test_the_tail_is_the_fraction_of_draws_that_are_no_more_likely(kinds: tuple[Distribution, ...], at: float) -> None:
    of, point = made(*kinds), np.full(len(kinds), at)
    for k, kind in enumerate(kinds):
        if kind is BELL:
            point[k] = 0.5 + SIGMA
    draws = drawn(*kinds)
    falls, own = sum(of.falls(draws)), float(sum(of.falls(point[None, :]))[0])
    fraction = float((falls >= own).mean())
    assert 0.01 < fraction < 0.99
    assert likelihood(of, point).tail == pytest.approx(fraction, abs=5 * np.sqrt(fraction / len(draws)))


def test_a_truncated_normal_at_its_bound_is_not_impossible() -> None:
    found = likelihood(made(TruncatedNormal(mean=5.0, deviation=0.5)), np.array([1.0]))
    assert (found.distance, found.tail) == (pytest.approx(2.0), pytest.approx(0.0, abs=1e-15))
    assert found.density == pytest.approx(np.exp(-2.0))


def test_what_cannot_be_stated_is_refused_with_the_reason() -> None:
    box = likelihood(made(Uniform(), Uniform()), np.array([0.0, 0.3]))
    assert (box.statement, [getattr(box, name) for name in NUMBERS]) == (claims.UNIFORM, [None] * 3)
    heaps = likelihood(made(BELL, Beta(alpha=0.5, beta=2.0)), np.array([0.5, 0.3]))
    assert [getattr(heaps, name) for name in NUMBERS] == [None] * 3
    assert heaps.statement == claims.unbounded(["a.1"])
    corner = likelihood(made(Triangular(mode=5.0)), np.array([0.0]))
    assert (corner.density, corner.distance, corner.tail) == (0.0, None, 0.0)


SKEWED = {
    "uniform": (Uniform(), Uniform()),
    "triangular": (Triangular(mode=6.0), Triangular(mode=5.5)),
    "beta": (Beta(alpha=2.0, beta=5.0), Beta(alpha=3.0, beta=1.5)),
    "truncated": (TruncatedNormal(mean=5.0, deviation=2.0), TruncatedNormal(mean=5.5, deviation=1.0)),
    "normal and uniform": (Normal(mean=5.0, deviation=0.3), Uniform()),
}
"""Correlated parameters of which not all are normal."""
STEP = 0.04
"""Half the width of the cells in which draws are counted."""


@pytest.mark.parametrize(
    ("kinds", "correlation"),
    rows_nightly_but(list(zip(SKEWED, cycle((0.9, -0.6)), strict=False)), product(SKEWED, (0.9, -0.6))),
)
def test_of_correlated_parameters_that_are_not_normal_only_the_order_is_stated(kinds: str, correlation: float) -> None:
    """No share of the draws follows from the distance in the standard normal space; how many draws are near a point
    shows which is more likely."""
    of = made(*SKEWED[kinds], Triangular(mode=5.0), correlation=correlation)
    draws = drawn(*SKEWED[kinds], correlation=correlation)
    points = np.random.default_rng(5).uniform(STEP, 1.0 - STEP, (40, 2))
    near = [int((np.abs(draws - at) <= STEP).all(axis=1).sum()) for at in points]
    points = np.column_stack([points, np.full(40, 0.5)])
    for one, other in zip(range(40), range(1, 40), strict=False):
        few, many = sorted((near[one], near[other]))
        if many < max(100, 1.7 * few):
            continue  # cells are too coarse and draws too few to tell which is more likely
        pair = Rows(1, 0, points[[one, other]], np.zeros((2, 1)), np.array([OK, OK], np.uint8))
        case = most_likely(1.0, of, {"a.0": 5.0, "a.1": 5.0, "a.2": 5.0}, [pair], "m").case
        assert case is not None
        assert case.index == int(near[other] > near[one])
        assert [getattr(case.likelihood, name) for name in NUMBERS] == [None] * 3
        assert (case.likelihood.parameters, case.likelihood.statement) == (3, claims.skewed(of.skewed))


def test_a_corner_is_no_less_likely_than_what_is_beside_it() -> None:
    of = made(Uniform(), Uniform(), correlation=0.9)
    for k, corner in enumerate(([0.0, 0.0], [1.0, 1.0])):
        ranks = of.ranks(np.array([corner, np.abs(np.array(corner) - 1e-9), [0.5, 0.5], [0.0, 0.5], [k, 1.0 - k]]))
        assert (np.diff(ranks) < 0.0).all()
    assert of.ranks(np.array([[0.0, 0.0]])) == pytest.approx(of.ranks(np.array([[1.0, 1.0]])))


def test_findings_without_a_number_have_one_line() -> None:
    reason = claims.skewed(["a.0", "a.1"])
    assert claims.lines({"F1": reason, "F2": reason}, ()) == [reason]
    assert len(claims.lines({"F1": reason, "F2": claims.UNIFORM}, ())) == 2
    assert len(claims.lines(dict.fromkeys(("F1", "F2"), claims.likelihood(0.5, 1.2, 0.4, 2, 2)), ())) == 2


def rows(position: int, first: int, points: list[float], costs: list[float], status: list[int], **more: Any) -> Rows:
    return Rows(
        position, first, np.array(points)[:, None], np.array(costs)[:, None], np.array(status, np.uint8), **more
    )


def test_the_most_likely_violation_is_the_nearest_of_all_stages() -> None:
    stored = [
        rows(2, 0, [0.5, 0.9, 0.8], [1.5, 0.2, 0.9], [OK, OK, OK]),
        rows(2, 3, [0.51, 0.52], [np.nan, np.nan], [FAILED, EXCLUDED]),
        rows(4, 7, [0.7, 0.3], [1.0, 0.5], [OK, OK], seeds=range(100, 108)),
    ]
    found = most_likely(1.0, made(BELL), {"a.0": 5.0}, stored, "m")
    assert found.violations == 4
    assert found.case is not None
    assert (found.case.position, found.case.index, found.case.realisation) == (4, 7, 107)
    assert found.case.parameters == {"a.0": pytest.approx(5.4)}
    assert (found.case.cost, found.case.margin) == (1.0, 0.0)
    assert found.case.likelihood.distance == pytest.approx(4.0)
    assert values(found.statement) == {"violations": 4, "margin": 0.0} | values(found.case.likelihood.statement)
    assert [part in found.text for part in ("evaluation 4:7", "not of all", "not validated")] == [True] * 3


def test_without_a_violation_or_a_likelihood_there_is_no_most_likely_one() -> None:
    stored = [rows(2, 0, [0.5, 0.9], [1.5, 0.2], [OK, OK])]
    none = most_likely(0.1, made(BELL), {"a.0": 5.0}, stored, "m")
    assert (none.violations, none.case, none.statement) == (0, None, claims.no_case(0, known=True, uniform=False))
    box = most_likely(1.0, made(Uniform()), {"a.0": 5.0}, stored, "m")
    assert (box.violations, box.case, box.statement) == (1, None, claims.UNIFORM)
    unknown = most_likely(1.0, None, {}, stored, "m")
    assert (unknown.violations, unknown.statement) == (1, claims.no_case(1, known=False, uniform=False))
    heaps = most_likely(1.0, made(Beta(alpha=0.5, beta=0.5)), {"a.0": 5.0}, stored, "m")
    assert (heaps.case, heaps.statement) == (None, claims.no_case(1, known=True, uniform=False))
    assert len({none.text, box.text, unknown.text, heaps.text}) == 4


def test_correlation_is_by_the_campaigns_pairs() -> None:
    pairs = [Correlation(between=["a.1", "a.2"], value=0.5)]
    paths = ("a.0", "a.1", "a.2")
    of = joined(dict.fromkeys(paths, BELL), pairs, dict.fromkeys(paths, (4.0, 6.0)))
    assert of.mixed == (1, 2)
    assert likelihood(of, 0.5 + SIGMA * np.array([1.0, 2.0, 0.0])).distance == pytest.approx(np.sqrt(1 + 4 / 0.75))
