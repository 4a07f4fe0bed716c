"""Auto: shares follow who leads, the witness learns nothing of the others, and two parts confirm each other."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from clearance.testing.searching import Function, batch, space
from tests.bench.scoreboard.searches import own_trace
from tests.given.at_night import nightly_but
from worker.engine.search.base import Floats
from worker.engine.search.methods import contrast_racing, lq_cma_es
from worker.engine.search.methods.auto import (
    ACROSS,
    AMID_FAILURES,
    AT_MOST,
    BELOW,
    COUNTED,
    COVER,
    EARLY,
    EVERY,
    LOW,
    MODELLED,
    MOVED,
    OPENING,
    RESTARTS,
    SEVERAL,
    SMALL,
    WIDE_COVER,
    WITNESS,
    Options,
    Team,
    adapted,
    method,
)
from worker.engine.search.parts.pycma import strategy

Parts = list[tuple[str, Floats, Floats]]
LEADING = ("sqp", "lq_cma_es", "cma_es", "direct")
"""Of more than a few parameters."""


def bowl(x: Floats) -> Floats:
    """Smooth: the first descent solves it."""
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


def stairs(x: Floats) -> Floats:
    """Of plateaus, on which descents along gradients stay where they begin."""
    return np.asarray(np.round(8 * np.abs(x - 0.3)).sum(axis=1))


def rugged(x: Floats) -> Floats:
    """Of many valleys, each of which a population can converge to."""
    return np.asarray((10 * (x - 0.3) ** 2 - np.cos(6 * np.pi * (x - 0.3))).sum(axis=1))


def requested(function: Function, dimension: int, budget: int, options: Options | None = None) -> Parts:
    """The points and their costs, by member and request."""
    told: list[tuple[str, int]] = []
    given = replace(space(dimension, budget), attribute=lambda member, count: told.append((member, count)))
    search, parts, asked = method.search(given, options or Options()), Parts(), 0
    points = next(search)
    while asked < budget:
        assert isinstance(points, np.ndarray)
        values = function(points)
        [(member, count)] = told
        assert count == len(points)
        parts.append((member, points.copy(), values))
        told.clear()
        asked += len(points)
        points = search.send(batch(values))
    search.close()
    return parts


def counted(parts: Parts) -> Counter[str]:
    count: Counter[str] = Counter()
    for member, points, _ in parts:
        count[member] += len(points)
    return count


@pytest.mark.parametrize("function", [bowl, stairs], ids=["bowl", "stairs"])
def test_the_witness_requests_what_it_would_request_alone(function: Function) -> None:
    """Fed with its own costs only, it asks for the same points to the bit, whatever the others found."""
    parts = [(points, values) for member, points, values in requested(function, 3, 1500) if member == "contrast_racing"]
    alone = Team(space(3, 1500), Options()).many.search
    points = next(alone)
    assert len(parts) > 5
    for mine, values in parts:
        assert np.array_equal(points, mine)
        points = alone.send(batch(values))
    alone.close()


@pytest.mark.nightly
def test_the_witness_has_its_smallest_share_while_the_others_lead() -> None:
    count = counted(requested(bowl, 4, 3000))
    share = count["contrast_racing"] / sum(count.values())
    assert WITNESS["above"] - 0.05 < share < WITNESS["equal"] + 0.05


def test_the_witness_gets_most_where_it_is_lower() -> None:
    """A basin that it finds, and that the others have left."""

    def trap(x: Floats) -> Floats:
        far = np.sqrt(((x - 0.9) ** 2).sum(axis=1))
        return np.asarray(((x - 0.2) ** 2).sum(axis=1) + np.where(far < 0.08, -50.0 + far, 0.0))

    team = Team(space(2, 1000), Options())
    team.many.used = 2 * COUNTED
    team.shared.lowest, team.many.lowest = 1.0, -3.0
    assert team._share() == WITNESS["below"]
    team.many.lowest = 1.0
    assert team._share() == WITNESS["equal"]
    count = counted(requested(trap, 2, 4000))
    assert count["contrast_racing"] > WITNESS["above"] * 4000


@pytest.mark.parametrize("dimension", [1, 2, LOW])
def test_few_parameters_begin_with_mlsl_then_the_witness_searches_enough(dimension: int) -> None:
    parts = requested(stairs, dimension, method.confirms * dimension)
    first = [member for member, _, _ in parts]
    at = first.index("contrast_racing")
    assert set(first[:at]) == {"mlsl"}
    assert set(first[at:]) >= {"contrast_racing"}
    assert counted(parts)["contrast_racing"] >= COUNTED * dimension


def test_mlsl_makes_way_where_many_evaluations_fail() -> None:
    def half(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.6, np.nan, bowl(x))

    count = counted(requested(half, 2, 400))
    assert 0 < count["mlsl"] < EARLY
    assert count["contrast_racing"] >= 2 * COUNTED


def test_a_smooth_cost_is_solved_by_the_first_descent() -> None:
    early = requested(bowl, 5, OPENING * 5)
    assert min(float(values.min()) for _, _, values in early) < 1e-12
    assert early[0][0] == "sqp"


def valley(x: Floats) -> Floats:
    """Rosenbrock's function over [-2, 2], with its minimum 0 at 1: long, curved and smooth."""
    z = 4.0 * x - 2.0
    return np.asarray((100.0 * (z[:, 1:] - z[:, :-1] ** 2) ** 2 + (1.0 - z[:, :-1]) ** 2).sum(axis=1))


@pytest.mark.nightly
def test_a_long_valley_is_descended_to_its_end() -> None:
    first = requested(valley, 20, OPENING * 20)
    assert counted(first)["sqp"] > 1.2 * AMID_FAILURES * 20
    assert min(float(values.min()) for _, _, values in first) < 1e-6


@pytest.mark.nightly
def test_cma_es_goes_on_from_where_the_model_has_come() -> None:
    """Along a sharp ridge, where the model still improves when its share has ended."""

    def ridge(x: Floats) -> Floats:
        return np.asarray((x[:, 0] - 0.1) ** 2 + 100.0 * np.sqrt(((x[:, 1:] - 0.3) ** 2).sum(axis=1)))

    parts = requested(ridge, 20, AT_MOST + 500)
    at = [member for member, _, _ in parts].index("cma_es")
    last = np.concatenate([points for member, points, _ in parts[:at] if member == "lq_cma_es"])[-50:]
    centre = last.mean(axis=0)
    away, spread = (np.linalg.norm(points - centre, axis=1).mean() for points in (parts[at][1], last))
    assert away < 1.5 * spread < 1.0


def test_cma_es_begins_anywhere_once_the_model_has_stopped_improving() -> None:
    space_of, descent = space(12, 1000), lq_cma_es.Descent()
    descent.strategy = strategy(np.full(12, 0.3), 1e-6, 11, space_of.random, 1e-9)
    first = next(adapted(space_of, descent, lambda: True))
    assert np.abs(first - 0.3).max() < 1e-4
    first = next(adapted(space_of, descent, lambda: False))
    assert np.abs(first - 0.3).max() > 0.1


@pytest.mark.nightly
def test_the_model_makes_way_for_an_evolution_strategy() -> None:
    cheap = counted(requested(stairs, 2, 1000))
    assert cheap["differential_evolution"] > cheap["lq_cma_es"] > 0
    assert cheap["cma_es"] == 0 < counted(requested(stairs, SMALL + 1, 200 * SMALL))["cma_es"]


@pytest.mark.parametrize("dimension", nightly_but((LOW - 1,), [LOW - 1, LOW + 1, SMALL]))
def test_mlsl_searches_the_box_once_differential_evolution_has_converged(dimension: int) -> None:
    parts = requested(rugged, dimension, 2000 * dimension)
    by = [member for member, _, _ in parts]
    late = next(k for k in range(len(by)) if by[k] == "mlsl" and k > by.index("differential_evolution"))
    counts = counted(parts[late:])
    leading = sum(counts.values()) - counts["contrast_racing"]
    assert counts["mlsl"] == pytest.approx(SEVERAL * leading, rel=0.1)
    assert counts["direct"] == pytest.approx(WIDE_COVER * leading, rel=0.2)
    assert counts["sqp"] == pytest.approx(BELOW * leading, rel=0.2)


@pytest.mark.nightly
def test_beyond_that_cma_es_begins_again_and_descents_get_more() -> None:
    parts = requested(rugged, SMALL + 1, 2000 * (SMALL + 1))
    assert counted(parts)["mlsl"] == 0
    late = counted(parts[len(parts) // 2 :])
    leading = sum(late.values()) - late["contrast_racing"]
    assert late["sqp"] == pytest.approx(RESTARTS * leading, rel=0.2)
    assert late["cma_es"] == pytest.approx((1.0 - RESTARTS - COVER) * leading, rel=0.1)


def test_a_star_takes_nothing_from_the_member_apart_and_comes_where_the_lowest_point_has_moved() -> None:
    n = SMALL + 2
    team = Team(space(n, 1000 * n), Options())
    team.shared.best, team.shared.lowest = np.full(n, 0.5), 1.0
    assert not team._looks_across()
    team.many.used = MODELLED * n
    assert team._looks_across()
    assert team._looks_across(), "until it is requested"
    assert team._weights(True) == [(team.axes, 1.0 - WITNESS["above"]), (team.many, WITNESS["above"])]
    team.axes.search, team.many.used = None, (MODELLED + 2 * EVERY) * n
    assert not team._looks_across(), "it has not moved"
    team.shared.best = np.full(n, 0.5 + MOVED)
    assert team._looks_across()
    team.axes.search, team.shared.best = None, np.full(n, 0.9)
    assert not team._looks_across(), "too early"


@pytest.mark.nightly
def test_a_star_takes_each_parameter_over_its_range_with_the_others_as_in_the_lowest_point() -> None:
    n = SMALL + 2
    parts = requested(stairs, n, 500 * n)
    stars = [k for k, (member, points, _) in enumerate(parts) if member == "lq_cma_es" and len(points) == ACROSS * n]
    assert stars
    for k in stars:
        points = parts[k][1]
        known = [(values.min(), before[values.argmin()]) for member, before, values in parts[:k] if member in LEADING]
        centre = min(known, key=lambda one: float(one[0]))[1]
        assert ((points != centre).sum(axis=1) == 1).all()
        assert (np.sort(points[points != centre].reshape(n, ACROSS)) // (1 / ACROSS) == np.arange(ACROSS)).all()


@pytest.mark.nightly
def test_a_star_comes_again_only_where_the_lowest_point_has_moved() -> None:
    n = SMALL + 2
    still = [len(points) for member, points, _ in requested(bowl, n, 1000 * n) if member == "lq_cma_es"]
    assert still.count(ACROSS * n) == 1


@pytest.mark.nightly
def test_every_other_descent_begins_anywhere() -> None:
    """The lowest of several bowls is the steepest, so that no point of it is low but near its minimum."""
    n = 2 * SMALL

    def modes(x: Floats) -> Floats:
        steep = 8.0 * ((x[:, 1:] - 0.8) ** 2).sum(axis=1)
        return np.asarray(np.where(x[:, 0] < 0.3, steep, 0.2 + ((x[:, 1:] - 0.2) ** 2).sum(axis=1)))

    lowest = [own_trace(method, modes, n, 1000 * n, seed, {}, stop=1e-3).lowest(1000 * n) for seed in range(3)]
    assert max(lowest) <= 1e-3


@pytest.mark.nightly
def test_of_few_parameters_a_narrow_valley_beside_a_wide_one_is_found() -> None:
    """Of 5 in 10,000 of the box; three times as far from its middle it lowers the wide one a little."""
    n, half_side = 4, 0.075

    def needle(x: Floats) -> Floats:
        away = np.abs(x - 0.8).max(axis=1) / half_side
        wide = ((x - 0.2) ** 2).mean(axis=1) - 0.1 * np.maximum(1.0 - away / 3.0, 0.0)
        return np.asarray(np.where(away < 1.0, 0.5 * away - 1.0, wide))

    lowest = [own_trace(method, needle, n, 1000 * n, seed, {}, stop=-0.5).lowest(1000 * n) for seed in range(6)]
    assert max(lowest) <= -0.5


def test_the_witness_of_few_costly_evaluations_is_turbo() -> None:
    costly = counted(requested(stairs, 2, 100, Options(seconds=1.0)))
    assert set(costly) == {"sqp", "lq_cma_es", "turbo"}


def test_a_cost_of_few_digits_is_descended_with_larger_differences() -> None:
    def printed(x: Floats) -> Floats:
        return np.round(bowl(x), 7)

    found = requested(printed, 4, OPENING * 4)
    assert min(float(values.min()) for _, _, values in found) < 1e-3


@pytest.mark.nightly
def test_a_first_descent_that_fails_often_ends_earlier() -> None:
    def half(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.6, np.nan, bowl(x))

    assert AMID_FAILURES * 6 <= counted(requested(half, 6, 2 * AMID_FAILURES * 6))["sqp"] < 1.2 * AMID_FAILURES * 6


@pytest.mark.nightly
def test_what_is_never_evaluated_is_searched_on() -> None:
    """More than half of the box fails, the centre included; the lowest value is at the edge of that."""

    def half(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.6, np.nan, bowl(x))

    lowest = [own_trace(method, half, 3, 900, seed, {}).lowest(900) for seed in range(5)]
    assert np.median(lowest) < 0.0901


def test_every_declared_member_that_is_apart_is_a_method_of_another_family() -> None:
    assert method.apart["contrast_racing"] == contrast_racing.method.family
    leading = {member.name for member in Team(space(2, 100), Options()).members if not member.apart}
    assert not leading & set(method.apart)
