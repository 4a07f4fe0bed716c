"""Parts of a search that were apart: who found what by itself, and what cannot be told."""

from __future__ import annotations

import numpy as np
import pytest

from campaigns.results.base import OK
from campaigns.stored.records import Columns
from worker.engine.search.base import Batch, Floats, Search
from worker.engine.stages.parts.members import Members
from worker.running.catalogue.installed import methods

POINTS = np.array([[0.1], [0.2], [0.3], [0.4]])
COSTS = np.array([3.0, 1.0, 2.0, 0.5])


def listened(names: list[str], points: Floats = POINTS) -> Members:
    """A search of which every request is one point, of these members; one without a name is not announced."""
    members = Members()

    def search() -> Search:
        for name, point in zip(names, points, strict=True):
            if name:
                members.attribute(name, 1)
            yield point[None]
        return "ended"

    listening = members.listening(search())
    next(listening)
    for cost in np.resize(COSTS, len(points) - 1):
        listening.send(Batch(np.array([[cost]]), np.zeros(1, dtype=np.uint8)))
    listening.close()
    return members


def columns(costs: Floats = COSTS) -> Columns:
    status = np.where(np.isfinite(costs), OK, OK + 1).astype(np.uint8)
    return Columns(POINTS, costs[:, None], status, np.zeros(len(costs)), {})


def test_every_side_has_its_own_best() -> None:
    found = listened(["sqp", "turbo", "cma_es", "sqp"]).apart(columns(), methods(), ["turbo"])
    assert [(a.member, a.best, a.index, a.evaluations) for a in found] == [("sqp", 0.5, 3, 3), ("turbo", 1.0, 1, 1)]
    assert found[0].family != found[1].family


def test_one_side_alone_is_none() -> None:
    alone = listened(["sqp", "turbo", "cma_es", "sqp"])
    assert alone.apart(columns(np.array([3.0, np.nan, 2.0, 0.5])), methods(), ["turbo"]) == []
    assert alone.apart(columns(), methods(), []) == []


def test_a_best_that_nobody_announced_is_no_ones() -> None:
    assert listened(["sqp", "turbo", "cma_es", ""]).apart(columns(), methods(), ["turbo"]) == []


@pytest.mark.parametrize("first", ["sqp", "turbo"])
def test_a_point_that_both_sides_requested_is_found_by_both_and_counted_once(first: str) -> None:
    second = {"sqp": "turbo", "turbo": "sqp"}[first]
    requests = [("sqp", 0), ("turbo", 1), (first, 3), ("cma_es", 2), (second, 3)]
    names, rows = [name for name, _ in requests], [row for _, row in requests]
    found = listened(names, POINTS[rows]).apart(columns(), methods(), ["turbo"])
    assert [(a.best, a.index) for a in found] == [(0.5, 3), (0.5, 3)]
    assert [a.member for a in found] == ["sqp", "turbo"]
    assert sum(a.evaluations for a in found) == len(POINTS)
