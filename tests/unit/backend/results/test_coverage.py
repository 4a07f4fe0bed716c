"""Figures of coverage against closed forms: grids of points, straight costs, evaluations without a value."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from backend.results.coverage import ball, slopes
from backend.results.coverage.read import Used, covered, pairs
from campaigns import Campaign
from campaigns.claims import coverage as sentences
from campaigns.claims.say import symbol
from campaigns.claims.spans import words
from tests.given.small_catalogue import CATALOGUE, campaign


def grid(values: np.ndarray, n: int) -> np.ndarray:
    return np.array(list(itertools.product(values, repeat=n)))


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("first", [0.0, 0.125], ids=["on the faces", "inside"])
def test_the_largest_ball_of_a_grid_is_half_a_diagonal_of_its_cells(n: int, first: float) -> None:
    points = grid(np.arange(first, 1.01, 0.25), n)
    found = ball.largest(points)
    assert found.radius == pytest.approx(0.125 * math.sqrt(n), abs=1e-6)
    assert found.radius == np.linalg.norm(points - found.centre, axis=1).min()
    assert ((found.centre >= 0.0) & (found.centre <= 1.0)).all()


@pytest.mark.parametrize(("n", "at"), [(1, 0.5), (3, 0.5), (3, 0.0), (20, 0.0), (20, 0.5)])
def test_around_one_evaluation_the_farthest_corner_is_found(n: int, at: float) -> None:
    found = ball.largest(np.full((1, n), at))
    assert found.radius == pytest.approx((1.0 - at) * math.sqrt(n), rel=1e-9)


@pytest.mark.parametrize("n", [2, 5])
def test_a_hole_in_a_dense_sample_is_found(n: int) -> None:
    points = np.random.default_rng(3).random((20_000, n))
    centre = np.full(n, 0.45)
    points = points[np.linalg.norm(points - centre, axis=1) > 0.4]
    found = ball.largest(points)
    assert found.radius >= 0.4 - 1e-6
    assert found.radius <= np.linalg.norm(points - found.centre, axis=1).min()


def test_the_same_evaluations_give_the_same_bits() -> None:
    points = np.random.default_rng(4).random((500, 3))
    first, second = ball.largest(points), ball.largest(points.copy())
    assert (first.radius, first.centre.tobytes()) == (second.radius, second.centre.tobytes())


def test_bins_of_pairs_are_counted_and_the_least_covered_are_first() -> None:
    a, b = np.meshgrid(np.linspace(0.0, 1.0, 11), np.linspace(0.05, 0.95, 10))
    points = np.column_stack([a.ravel(), b.ravel(), np.full(a.size, 1.0)])
    found = [(pair.first, pair.second, pair.touched) for pair in pairs(points, "abc")]
    assert found == [("a", "c", 10), ("b", "c", 10), ("a", "b", 100)]


def test_one_parameter_has_no_pair() -> None:
    assert pairs(np.array([[0.5]]), "a") == []


@pytest.mark.parametrize("threshold", [-0.5, 0.0, 0.25, 0.9, 2.0])
def test_a_straight_cost_leaves_the_side_that_violates(threshold: float) -> None:
    points = np.linspace(0.0, 1.0, 101)[:, None]
    found = slopes.possible(points, points[:, 0], threshold)
    assert found is not None
    assert found.slope == pytest.approx(1.0, rel=1e-9)
    truth = min(max(threshold, 0.0), 1.0)
    assert abs(found.fraction - truth) <= 4.0 * math.sqrt(truth * (1.0 - truth) / found.points)
    assert found.standard_error == pytest.approx(math.sqrt(found.fraction * (1.0 - found.fraction) / found.points))


def test_an_evaluation_rules_out_a_ball_of_its_margin_over_the_slope() -> None:
    points, costs = np.array([[0.5, 0.5], [0.0, 0.5]]), np.array([2.3, 1.8])
    found = slopes.possible(points, costs, 2.0)  # a slope of 1, and the second one violates
    truth = 1.0 - math.pi * 0.3**2
    assert found is not None
    assert found.slope == pytest.approx(1.0)
    assert abs(found.fraction - truth) <= 4.0 * found.standard_error


@pytest.mark.parametrize("at", [0.5, 0.4955], ids=["in one cell", "in two cells"])
def test_a_jump_between_nearer_evaluations_is_no_slope(at: float) -> None:
    points, costs = np.array([[at], [at + 0.9 * slopes.APART]]), np.array([0.0, 100.0])
    assert slopes.steepest(points, costs) is None
    assert slopes.possible(points, costs, 1.0) is None


def test_the_steepest_slope_of_a_bent_cost_is_found() -> None:
    points = np.linspace(0.0, 1.0, 51)[:, None]
    assert slopes.steepest(points, points[:, 0] ** 2) == pytest.approx(1.0 + 0.98)


def test_a_cluster_does_not_hide_the_slope_around_it() -> None:
    cluster = 0.5 + 1e-5 * np.random.default_rng(7).standard_normal((500, 2))
    points = np.vstack([[[0.5, 0.5]], cluster, [[0.55, 0.5]]])
    found = slopes.steepest(points, np.append(np.zeros(501), 1.0))
    assert found == pytest.approx(20.0, rel=1e-3)


@pytest.mark.parametrize(("threshold", "fraction"), [(0.9, 0.0), (1.0, 1.0), (1.1, 1.0)])
def test_a_constant_cost_is_ruled_out_everywhere_or_nowhere(threshold: float, fraction: float) -> None:
    found = slopes.possible(np.random.default_rng(5).random((50, 3)), np.ones(50), threshold)
    assert found is not None
    assert (found.slope, found.fraction, found.standard_error) == (0.0, fraction, 0.0)


@pytest.fixture
def request_of_two() -> Campaign:
    """Of vehicle.m in 4 to 6 kg and vehicle.J in 0.04 to 0.06 kg m^2."""
    return Campaign.model_validate(campaign())


def test_evaluations_without_a_value_fill_balls_and_bins_and_rule_out_no_volume(request_of_two: Campaign) -> None:
    points = grid(np.linspace(0.0, 1.0, 5), 2)
    costs = np.where(points[:, 0] > 0.6, np.nan, 0.6 + points[:, 0])
    found = covered(Used(points, costs, len(points)), request_of_two, CATALOGUE)
    assert found.without_value == 10
    assert found.ball is not None
    assert found.possible is not None
    assert found.ball.radius == 0.176
    few = covered(Used(points[costs < 9], costs[costs < 9], 15), request_of_two, CATALOGUE)
    assert few.ball is not None
    assert few.ball.radius > 0.49
    assert (few.possible, few.without_value) == (found.possible, 0)
    assert sentences.without_value(10) in found.statements


def test_nothing_evaluated_covers_nothing(request_of_two: Campaign) -> None:
    found = covered(Used(np.empty((0, 2)), np.empty(0), 0), request_of_two, CATALOGUE)
    assert (found.used, found.ball, found.possible, [pair.touched for pair in found.pairs]) == (0, None, None, [0])
    assert found.statements == [sentences.NO_EVALUATION, sentences.NO_PROOF]


@pytest.mark.parametrize(("least", "word"), [(1.0, "none"), (0.4, "all")])
def test_where_all_points_agree_no_standard_error_is_stated(request_of_two: Campaign, least: float, word: str) -> None:
    points = np.random.default_rng(8).random((3000, 2))
    found = covered(Used(points, least + 0.1 * points[:, 0], 3000), request_of_two, CATALOGUE)
    *_, volume, _ = map(words, found.statements)
    assert f"{word} of 4" in volume
    assert "standard error" not in volume


def test_failures_alone_give_no_slope(request_of_two: Campaign) -> None:
    found = covered(Used(np.full((3, 2), 0.5), np.full(3, np.nan), 3), request_of_two, CATALOGUE)
    assert found.possible is None
    assert found.ball is not None
    assert sentences.NO_SLOPE in found.statements


def test_the_sentences_state_the_figures_and_last_that_they_are_no_proof(request_of_two: Campaign) -> None:
    points = grid(np.linspace(0.0, 1.0, 5), 2)
    found = covered(Used(points, 0.3 + points[:, 0], 50), request_of_two, CATALOGUE)
    assert found.possible is not None
    assert found.possible.slope == pytest.approx(1.0)
    assert found.statements == [
        sentences.used(25, 50),
        sentences.ball(0.176, math.sqrt(2.0)),
        sentences.bins(symbol("vehicle.m", "m"), symbol("vehicle.J", "J"), 25, 100),
        sentences.volume(found.possible.slope, "m", 0.01, found.possible.fraction, 4096, found.possible.standard_error),
        sentences.NO_PROOF,
    ]
