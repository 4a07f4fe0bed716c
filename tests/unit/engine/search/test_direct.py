"""DIRECT against the published counts of Jones, Perttunen and Stuckman (1993), table 2; regions without values; stops.

The counts are of evaluations until the lowest value is within 1 % and 0.01 % of the optimum, read at the end of an
iteration, which is where the paper can stop too.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns.codes import StopCode
from campaigns.stored.records import Columns, StagePlan
from clearance.testing.searching import Searched, batch, run, space
from tests.given.case_campaigns import campaign, case1
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import PUBLISHED, on_unit_cube
from worker.engine.search.base import Batch, Floats, Method
from worker.engine.search.methods import direct, direct_l
from worker.engine.search.methods.direct import method
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context, Driven
from worker.running.runs.store import MemoryStore


def counted(name: str, within: float) -> int:
    f = on_unit_cube(name)
    found = run(method, f, f.dimension, 20_000, until=lambda found: f.gap(found.lowest) < within)
    return sum(map(len, found.batches))


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_counts_are_the_published_ones(name: str) -> None:
    assert (counted(name, 1e-2), counted(name, 1e-4)) == PUBLISHED[name]


def bowl(x: Floats) -> Floats:
    return np.asarray(((x - 0.3) ** 2).sum(axis=1))


@pytest.mark.parametrize("dimension", [1, 2, 3, 5])
def test_points_are_distinct_and_lie_inside(dimension: int) -> None:
    points = run(method, bowl, dimension, 4000).points
    assert len(np.unique(points, axis=0)) == len(points)
    assert points.shape[1] == dimension
    assert (points > 0).all()
    assert (points < 1).all()


def test_batches_are_whole_iterations() -> None:
    found = run(method, bowl, 3, 2000)
    assert found.batches[0].tolist() == [[0.5, 0.5, 0.5]]
    assert len(found.batches[1]) == 6  # the centre's box along every side
    centres = {tuple(found.batches[0][0])}
    for points in found.batches[1:]:
        assert len(points) % 2 == 0
        pairs = points.reshape(-1, 2, 3)
        middle = pairs.mean(axis=1)
        assert {tuple(np.round(m, 12)) for m in middle} <= {tuple(np.round(c, 12)) for c in centres}
        centres |= set(map(tuple, points))


def test_what_happens_in_the_middle_of_ties_is_symmetric() -> None:
    # The function and the box are mirrored in both axes: so must be the points of every iteration.
    found = run(method, lambda x: ((x - 0.5) ** 2).sum(axis=1), 2, 600)
    for points in found.batches:
        rounded = np.round(points, 9)
        for mirror in ([1, 0], [0, 1]):
            mirrored = np.round(np.where(mirror, 1 - points, points), 9)
            assert set(map(tuple, rounded)) == set(map(tuple, mirrored))


def edge(x: Floats) -> Floats:
    """Falls towards the wall at x = 0.37, beyond which there is no value."""
    values = (x[:, 0] - 1) ** 2 + 0.1 * (x[:, 1] - 0.6) ** 2
    return np.where(x[:, 0] > 0.37, np.nan, values)


@pytest.mark.parametrize("status", [1, 2, 3])
def test_an_optimum_at_the_edge_of_a_region_without_values_is_found(status: int) -> None:
    found = run(method, edge, 2, 3000, status=status)
    values = np.concatenate(found.values)
    best = found.points[np.nanargmin(values)]
    assert best == pytest.approx([0.37, 0.6], abs=1e-3)
    assert np.isnan(values).mean() < 0.6  # it does not drown in the region


def test_points_without_a_value_at_the_centre() -> None:
    def holed(x: Floats) -> Floats:
        return np.where(np.abs(x - 0.5).max(axis=1) < 0.1, np.nan, bowl(x))

    assert run(method, holed, 2, 1000).lowest < 1e-6


def test_nothing_but_failures_uses_the_budget() -> None:
    found = run(method, lambda x: np.full(len(x), np.nan), 2, 500)
    points = found.points
    assert len(points) >= 500
    assert len(np.unique(points, axis=0)) == len(points)


def test_a_failed_centre_takes_the_lowest_value_nearby() -> None:
    boxes = direct.Boxes(2)
    third = 1 / 3
    centre = np.array([[0.5, 0.5], [0.5 - third, 0.5], [0.5 + third, 0.5]])
    boxes.add(centre, np.array([[1, 0]] * 3), np.array([4.0, np.inf, np.inf]))
    direct._rescue(boxes, np.empty(0, dtype=np.int64), 0)
    # Both neighbours are exactly one side away: their boxes at twice the size reach the centre.
    assert boxes.value[:3] == pytest.approx([4.0, 4.0 + 4e-6, 4.0 + 4e-6], abs=1e-12)


def test_values_carried_between_iterations_equal_recomputed_ones() -> None:
    chance = np.random.default_rng(1)
    boxes = direct.Boxes(2)
    boxes.add(np.array([[0.5, 0.5]]), np.zeros((1, 2), dtype=np.int64), np.array([1.0]))
    for _ in range(25):
        parents = direct.promising(boxes, 1e-4)
        points, owners, sides = direct._new_centres(boxes, parents)
        values = np.where(chance.random(len(points)) < 0.4, np.inf, bowl(points))
        first = boxes.count
        direct._divide(boxes, parents, points, owners, sides, values)
        direct._rescue(boxes, parents, first)
        lost = np.flatnonzero(boxes.lost[: boxes.count])
        feasible = np.flatnonzero(~boxes.lost[: boxes.count])
        assert np.array_equal(boxes.near[lost], direct._lowest_near(boxes, lost, feasible))
    assert boxes.lost[: boxes.count].sum() > 50


def test_rules_by_which_it_stops() -> None:
    ten = run(method, bowl, 2, 10_000, options={"iterations": 10})
    assert ten.text == "completed the 10 iterations"
    assert len(ten.batches) == 11
    small = run(method, bowl, 2, 10_000, options={"smallest": 0.01})
    code, numbers = ending(small.text)
    assert (code, numbers["smallest"]) == (StopCode.RESOLUTION, 0.01)
    budget = run(method, bowl, 2, 100)
    assert budget.text is None
    assert sum(map(len, budget.batches[:-1])) < 100


@pytest.mark.parametrize("end", [{"iterations": 12}, {"smallest": 0.01}, {}])
@pytest.mark.parametrize("variant", [method, direct_l.method], ids=lambda m: m.name)
def test_a_finished_search_is_extended_without_repeating_an_evaluation(variant: Method, end: dict[str, Any]) -> None:
    """Stored evaluations are reused; further ones equal those of one long search."""
    options = direct.Options(**end)
    assert variant.extend is not None
    flown: list[Floats] = []

    def evaluate(points: Floats) -> tuple[Batch, dict[int, str]]:
        flown.append(points.copy())
        return batch(bowl(points)), {}

    def searched(options: direct.Options, budget: int, stored: Columns | None) -> Driven:
        store = MemoryStore(chunks={} if stored is None else {0: [stored]})
        store.plan([StagePlan("search", variant.name, budget)])
        context = Context(campaign(), case1(), evaluate, store)
        return drive(context, 0, variant.search(space(3, budget), options), budget)

    first = searched(options, 1200, None)
    assert first.stop == ("rule" if end else "budget")
    before = first.tally.evaluations
    longer, budget = variant.extend(options, 900), before + 900
    flown.clear()
    second = searched(longer, budget, first.columns)
    assert first.columns is not None
    assert second.columns is not None
    assert second.tally.evaluations == budget
    new = np.concatenate(flown)
    assert len(new) == 900
    assert np.array_equal(second.columns.points, np.concatenate([first.columns.points, new]))
    assert len(np.unique(second.columns.points, axis=0)) == budget
    long = searched(longer, budget, None)
    assert long.columns is not None
    assert np.array_equal(long.columns.points, second.columns.points)
    assert np.array_equal(long.columns.costs, second.columns.costs)
    assert long.tally.best == second.tally.best


def test_sizes_are_half_diagonals() -> None:
    # One side of length 1/3 and one of 1: half of sqrt(1/9 + 1).
    assert direct.sizes(np.array([0, 1, 2]), 2) == pytest.approx(
        [0.5**0.5, 0.5 * (10 / 9) ** 0.5, 0.5 * (2 / 9) ** 0.5]
    )


def test_it_asks_for_the_same_points_every_time() -> None:
    one, two = (run(method, bowl, 3, 1000, seed=seed) for seed in (1, 2))
    assert np.array_equal(one.points, two.points)
    assert isinstance(one, Searched)
    assert space(3, 1).budget == 1
