"""GLOBAL: critical distance, clustering, stopping rules, reported minima; UNIRANDI's lines and steps."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from typing import Any

import numpy as np
import pytest

from campaigns.codes import StopCode
from campaigns.results.base import EXCLUDED, FAILED
from clearance.testing.searching import Function, Searched, batch
from clearance.testing.searching import run as searched
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Batch, Floats, Minimum
from worker.engine.search.methods import global_clustering
from worker.engine.search.methods.global_clustering import (
    ALONE,
    Clusters,
    Found,
    Options,
    Sample,
    critical_distance,
    method,
)
from worker.engine.search.parts.descent import End
from worker.engine.search.parts.unirandi import STEP, unirandi


def run(*given: Any, options: Mapping[str, object] | None = None, **more: Any) -> Searched:
    """As published, unless other options are given."""
    return searched(*given, options={"as_published": True, **(options or {})}, **more)


def two_bowls(x: Floats) -> Floats:
    """Two symmetric basins with minima of 0 at 0.25 and 0.75 of every range."""
    return np.asarray(np.minimum(((x - 0.25) ** 2).sum(axis=1), ((x - 0.75) ** 2).sum(axis=1)))


def played(
    search: Generator[Floats, Batch, End], function: Callable[[Floats], Floats], status: int = FAILED
) -> tuple[End, list[Floats]]:
    asked = []
    try:
        points = next(search)
        while True:
            asked.append(points.copy())
            points = search.send(batch(function(points), status))
    except StopIteration as ended:
        return ended.value, asked


def descent(function: Function, start: list[float], seed: int = 1, most: int = 10_000) -> tuple[End, list[Floats]]:
    at = np.array(start)
    cost = float(function(at[None, :])[0])
    return played(unirandi(np.random.default_rng(seed), at, cost, 1e-6, most), function)


def test_the_critical_distance_is_the_papers() -> None:
    """1 - 0.01^(1/99) is 0.04545: a square with that fraction of the box of side 2 has half a side of 0.2132."""
    assert critical_distance(100, 2) == pytest.approx(0.5 * 0.0454552**0.5, rel=1e-4)
    assert critical_distance(200, 1) == pytest.approx(0.5 * 0.0228762, rel=1e-4)
    assert critical_distance(1000, 3) < critical_distance(100, 3) < critical_distance(100, 6)


def clustered(points: list[list[float]], costs: list[float], distance: float) -> Clusters:
    sample = Sample(np.empty((0, len(points[0]))), np.empty(0), np.empty(0, dtype=np.int64))
    sample.add(np.array(points), np.array(costs))
    return Clusters(sample, len(costs), [Found(np.zeros(len(points[0])), 0.0)], distance)


def test_single_linkage_goes_from_point_to_point_and_only_uphill() -> None:
    chain = clustered([[0.1, 0.0], [0.2, 0.1], [0.3, 0.0], [0.45, 0.0], [0.9, 0.9]], [1.0, 2.0, 3.0, 4.0, 5.0], 0.12)
    chain.grow(0, np.zeros(2), 0.0)
    assert chain.sample.cluster.tolist() == [0, 0, 0, ALONE, ALONE]
    dip = clustered([[0.1, 0.0], [0.2, 0.0]], [2.0, 1.0], 0.12)  # the second is lower than what links it
    dip.grow(0, np.zeros(2), 0.0)
    assert dip.sample.points[:, 0].tolist() == [0.2, 0.1]
    assert dip.sample.cluster.tolist() == [ALONE, 0]


def test_the_distance_is_the_largest_of_the_coordinates() -> None:
    corner = clustered([[0.11, 0.11]], [1.0], 0.12)
    corner.grow(0, np.zeros(2), 0.0)
    assert corner.sample.cluster.tolist() == [0]


def test_only_the_best_of_the_sample_are_clustered() -> None:
    few = clustered([[0.1], [0.2], [0.3]], [1.0, 2.0, 3.0], 0.15)
    few.reduced = 2
    few.grow(0, np.zeros(1), 0.0)
    assert few.sample.cluster.tolist() == [0, 0, ALONE]
    assert few.alone() == []


def test_points_without_a_value_never_enter_the_sample() -> None:
    sample = Sample(np.empty((0, 2)), np.empty(0), np.empty(0, dtype=np.int64))
    costs = np.array([3.0, np.inf, 1.0])
    sample.add(np.arange(6.0).reshape(3, 2)[np.isfinite(costs)], costs)
    assert sample.costs.tolist() == [1.0, 3.0]
    assert sample.points.tolist() == [[4.0, 5.0], [0.0, 1.0]]


def test_points_keep_their_cluster_when_others_come() -> None:
    one = clustered([[0.1], [0.9]], [1.0, 2.0], 0.15)
    one.grow(0, np.zeros(1), 0.0)
    one.sample.add(np.array([[0.5]]), np.array([1.5]))
    assert one.sample.costs.tolist() == [1.0, 1.5, 2.0]
    assert one.sample.cluster.tolist() == [0, ALONE, ALONE]


@pytest.mark.parametrize("local", ["unirandi", "bfgs"])
def test_a_sample_is_one_batch_and_its_size_is_set_by_the_dimension(local: str) -> None:
    found = run(method, two_bowls, 4, 2000, options={"local": local})
    assert len(found.batches[0]) == 40
    asked = run(method, two_bowls, 4, 2000, options={"local": local, "samples": 33})
    assert len(asked.batches[0]) == 33


def test_unirandi_asks_for_one_point_at_a_time() -> None:
    found = run(method, two_bowls, 3, 2000)
    assert {len(b) for b in found.batches} == {30, 1}


@pytest.mark.parametrize("options", [{}, {"local": "bfgs"}, {"at_once": True}, {"local": "bfgs", "at_once": True}])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_it_reports_both_of_two_basins(options: dict[str, Any], seed: int) -> None:
    found = run(method, two_bowls, 2, 5000, seed=seed, options={"samples": 100, "selected": 10, **options})
    assert len(found.minima) == 2
    for centre in (0.25, 0.75):
        assert min(np.abs(m.point - centre).max() for m in found.minima) < 1e-3
    assert found.text is not None
    assert found.text.endswith("; 2 are known")
    for m in found.minima:
        assert m.start is not None
        assert m.cost < two_bowls(m.start[None, :])[0]
        assert m.evaluations > 0


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("name", "known"), [("Branin", 3), ("six-hump camel", 2), ("Shubert", 8)])
def test_it_finds_the_minimisers_of_functions_with_several(name: str, known: int) -> None:
    f = on_unit_cube(name, 1)
    found = run(method, f, 2, 20_000, options={"samples": 200, "selected": 20, "minima": 1000})
    reached = [
        least for least in f.minimisers if min(np.abs(m.point - least).max() for m in found.minima) < 1e-2
    ]  # fmt: skip
    assert len(reached) >= known
    assert len(found.minima) < 400


def test_by_default_it_begins_again_with_another_sample_until_the_budget_ends() -> None:
    published, found = run(method, two_bowls, 2, 3000), searched(method, two_bowls, 2, 3000)
    count = len(published.points)
    assert published.text is not None
    assert (len(found.points) >= 3000, found.text) == (True, None)
    assert np.array_equal(found.points[:count], published.points)
    assert not np.array_equal(found.points[count : count + 20], found.points[:20])


def test_it_stops_at_the_number_of_minima_asked_for() -> None:
    f = on_unit_cube("Shubert", 1)
    found = run(method, f, 2, 20_000, options={"minima": 4})
    assert found.text == "found the requested 4 local minima"
    places = {tuple(np.round(m.point, 2)) for m in found.minima}
    assert len(places) == 4


def test_its_local_searches_keep_to_their_evaluations() -> None:
    f = on_unit_cube("Hartman 6", 1)
    for local in ("unirandi", "bfgs"):
        found = run(method, f, 6, 5000, options={"local_evaluations": 40, "local": local})
        assert found.minima
        assert max(m.evaluations for m in found.minima) <= 40
        assert any(m.text == "used its 40 evaluations" for m in found.minima)


def test_a_minimum_is_reported_as_soon_as_it_is_found() -> None:
    minima: list[Minimum] = []
    found = run(method, two_bowls, 2, 10**6, until=lambda f: bool(f.minima))
    minima += found.minima
    assert len(minima) == 1
    assert len(found.batches) < 300


def test_digits_set_how_exact_a_minimum_is() -> None:
    lowest = []
    for digits in (2, 5, 9):
        found = run(method, two_bowls, 2, 20_000, options={"digits": digits, "local_evaluations": 5000})
        lowest.append(found.lowest)
    assert lowest[0] > lowest[1] > lowest[2]


@pytest.mark.parametrize("status", [FAILED, EXCLUDED])
@pytest.mark.parametrize("local", ["unirandi", "bfgs"])
def test_it_never_starts_where_there_is_no_value(status: int, local: str) -> None:
    def holed(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.5, np.nan, two_bowls(x))

    found = run(method, holed, 2, 3000, status=status, options={"local": local})
    assert found.minima
    for m in found.minima:
        assert m.start is not None
        assert m.start[0] >= 0.5
        assert m.point[0] >= 0.5
    assert found.lowest < 1e-6


def test_it_gives_up_where_nothing_has_a_value() -> None:
    found = run(method, lambda x: np.full(len(x), np.nan), 2, 10_000)
    assert found.text == "no point of 200 had a value"
    assert [len(b) for b in found.batches] == [20] * 10


def test_at_once_spends_a_little_more_in_far_fewer_requests() -> None:
    requests, evaluations = {}, {}
    for at_once in (False, True):
        runs = [
            run(method, on_unit_cube("Shekel 10", s), 4, 10_000, seed=s, options={"at_once": at_once})
            for s in range(10)
        ]
        requests[at_once] = sum(len(r.batches) for r in runs)
        evaluations[at_once] = sum(len(r.points) for r in runs)
    assert requests[True] < 0.7 * requests[False]
    assert evaluations[True] < 2.5 * evaluations[False]


def test_unirandi_descends_to_the_minimum() -> None:
    end, _ = descent(two_bowls, [0.4, 0.1])
    assert end.point == pytest.approx([0.25, 0.25], abs=1e-3)
    assert end.cost == two_bowls(end.point[None, :])[0]
    raised, _ = descent(lambda x: 1 + two_bowls(x), [0.4, 0.1])
    assert ending(end.text) == ending(raised.text) == (StopCode.CONVERGED, {})
    assert end.text != raised.text, "one by its step, one by its cost"


def test_unirandi_doubles_a_line_that_succeeds() -> None:
    """On a slope every first or second trial succeeds, and the line is followed by steps of 1, 2, 4 times the first."""
    _, asked = descent(lambda x: x[:, 0], [0.5, 0.5], most=6)
    moves = np.diff(np.array([[0.5, 0.5], *(a[0] for a in asked)]), axis=0)
    lengths = np.linalg.norm(moves, axis=1)
    first = 0 if asked[0][0, 0] < 0.5 else 1  # in the opposite direction if the first trial fails
    lengths = lengths[first:]
    lengths[0] = STEP
    assert lengths == pytest.approx(STEP * 2.0 ** np.arange(len(lengths)))


def test_unirandi_halves_after_two_failures() -> None:
    """Where nothing is lower it tries both ways of two directions, then half as far."""
    _, asked = descent(lambda x: np.where((x == 0.5).all(axis=1), 0.0, 1.0), [0.5, 0.5, 0.5], most=12)
    reach = [float(np.linalg.norm(a[0] - 0.5)) for a in asked]
    assert reach == pytest.approx([STEP] * 4 + [STEP / 2] * 4 + [STEP / 4] * 4)
    assert asked[0][0] - 0.5 == pytest.approx(0.5 - asked[1][0])


def test_unirandi_ends_by_its_step_where_nothing_is_lower() -> None:
    end, asked = descent(lambda x: np.where((x == 0.5).all(axis=1), 0.0, 1.0), [0.5, 0.5])
    assert end.text == descent(two_bowls, [0.4, 0.1])[0].text
    assert end.cost == 0.0
    assert len(asked) == 4 * (1 + int(np.log2(STEP / 1e-6)))


def test_unirandi_ends_on_a_corner_exactly() -> None:
    end, asked = descent(lambda x: -x.sum(axis=1), [0.6, 0.7, 0.2])
    assert end.point.tolist() == [1.0, 1.0, 1.0]
    assert len({a.tobytes() for a in asked}) > 0.9 * len(asked)


def test_unirandi_never_accepts_what_failed() -> None:
    def walled(x: Floats) -> Floats:
        return np.where(x[:, 0] < 0.5, np.nan, x[:, 0] + (x[:, 1] - 0.3) ** 2)

    end, _ = descent(walled, [0.9, 0.9])
    assert end.point[0] >= 0.5
    assert end.cost == pytest.approx(0.5, abs=0.01)


def test_the_same_minimum_is_not_reported_twice() -> None:
    f = on_unit_cube("Hartman 3", 2)
    found = run(method, f, 3, 10_000, options={"local_evaluations": 5000})
    for i, one in enumerate(found.minima):
        for other in found.minima[:i]:
            close = np.abs(one.point - other.point).max() < 1e-3
            assert not close or one.cost < other.cost - 1e-6 * abs(other.cost)
    assert isinstance(global_clustering.method.options(), Options)
