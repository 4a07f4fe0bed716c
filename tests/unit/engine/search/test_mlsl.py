"""MLSL: visits every valley, in batches and slots, does not stop by itself, handles points without a value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import get_args, get_type_hints

import numpy as np
import pytest

from clearance.testing.searching import batch, run, space
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Floats, Several
from worker.engine.search.methods.mlsl import Options, method
from worker.engine.search.parts.levels import Levels

BOTTOMS = ([0.25, 0.25], [0.25, 0.75], [0.75, 0.25], [0.75, 0.75])
LOCALS = get_args(get_type_hints(Options)["local"])


def four_valleys(x: Floats) -> Floats:
    return np.asarray(np.cos(4 * np.pi * x).sum(axis=1) + x @ [0.2, 0.1])


@pytest.mark.parametrize("local", LOCALS)
def test_every_valley_is_visited(local: str) -> None:
    found = run(method, four_valleys, 2, 2500, options={"local": local})
    assert found.text is None
    for bottom in BOTTOMS:
        assert np.abs(found.points - bottom).max(axis=1).min() < 0.01
    assert len(found.batches) < len(found.points) / 3, "local searches run side by side"
    assert min(minimum.cost for minimum in found.minima) == pytest.approx(found.lowest, abs=1e-9)
    ends = np.array([minimum.point for minimum in found.minima])
    assert all(np.abs(ends - bottom).max(axis=1).min() < 0.01 for bottom in BOTTOMS), "every end is reported"


def test_the_published_program_requests_one_point_at_a_time() -> None:
    found = run(method, four_valleys, 2, 2500, options={"as_published": True})
    assert {len(b) for b in found.batches} == {1}
    for bottom in BOTTOMS:
        assert np.abs(found.points - bottom).max(axis=1).min() < 0.01
    (minimum,) = found.minima
    assert minimum.cost == found.lowest


def in_slots(answer: Callable[[list[tuple[int, Floats]]], int], budget: int) -> Floats:
    """The points of a search in slots, whose groups end in the order that `answer` chooses."""
    search = method.search(replace(space(2, budget), slots=4), Options())
    request, pending, points = next(search), list[tuple[int, Floats]](), list[Floats]()
    while sum(map(len, points)) < budget:
        assert isinstance(request, Several)
        pending += request.groups
        number, group = pending.pop(answer(pending))
        points.append(group)
        request.answered = number
        request = search.send(batch(four_valleys(group)))
    search.close()
    return np.concatenate(points)


@pytest.mark.parametrize("last", [False, True])
def test_in_slots_each_continues_by_itself(last: bool) -> None:
    points = in_slots(lambda pending: -1 if last else 0, 800)
    for bottom in BOTTOMS:
        assert np.abs(points - bottom).max(axis=1).min() < 0.01
    assert in_slots(lambda pending: -1 if last else 0, 800).tobytes() == points.tobytes()


def test_a_local_search_that_cannot_move_tries_larger_differences() -> None:
    found = run(method, lambda x: np.round(four_valleys(x), 6), 2, 1500, options={"local": "slsqp"})
    for bottom in BOTTOMS:
        assert np.abs(found.points - bottom).max(axis=1).min() < 0.02


def test_a_search_begins_where_nothing_lower_is_near() -> None:
    levels = Levels(2)
    points = np.array([[0.1, 0.1], [0.9, 0.9], [0.12, 0.1], [0.5, 0.1], [0.1, 0.9], [0.9, 0.1], [0.5, 0.5]])
    levels.add(np.concatenate([points, np.full((200, 2), 0.5)]), np.concatenate([np.arange(7.0), np.full(200, np.inf)]))
    assert levels.sampled == 207
    assert levels.critical() == pytest.approx(np.sqrt(2 * np.log(207) / 207 / np.pi))
    assert levels.starts(10).tolist() == [0, 1], "of the three lowest, the third has a lower one nearby"
    assert levels.starts(10).tolist() == [], "each once"
    levels.add(np.array([[0.7, 0.7], [0.7, 0.72]]), np.array([-2.0, -1.0]))
    levels.ended(np.array([0.71, 0.7]), -3.0)
    assert levels.starts(10).tolist() == [], "a lower minimum is near"


@pytest.mark.parametrize("local", LOCALS)
def test_points_without_a_value_do_not_end_it(local: str) -> None:
    found = run(method, lambda x: np.where(x[:, 0] > 0.6, np.nan, four_valleys(x)), 2, 1000, options={"local": local})
    assert found.lowest < -1.8
    assert run(method, lambda x: np.full(len(x), np.nan), 2, 200, options={"local": local}).minima == []


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", ["Branin", "Hartman 3", "Shekel 7"])
def test_the_known_minimum_is_found(name: str) -> None:
    function = on_unit_cube(name, 1)
    assert function.gap(run(method, function, function.dimension, 5000).lowest) < 0.01


@pytest.mark.parametrize("as_published", [True, False])
def test_its_points_do_not_depend_on_the_budget(as_published: bool) -> None:
    short, long = (
        run(method, four_valleys, 2, budget, options={"as_published": as_published}) for budget in (300, 600)
    )
    for one, other in zip(short.batches[:-1], long.batches, strict=False):
        assert np.array_equal(one, other)
