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


class _Counted(dict[bytes, set[str]]):
    """A dictionary that counts in how many points it is asked for."""

    lookups = 0

    def get(self, key: bytes, default: object = None) -> object:  # type: ignore[override]
        self.lookups += 1
        return super().get(key, default)

    def __contains__(self, key: object) -> bool:
        self.lookups += 1
        return super().__contains__(key)


def test_rows_and_apart_read_every_evaluation_once_whatever_the_number_of_members() -> None:
    names = ["sqp", "turbo", "cma_es", "direct", "genetic"]
    points = np.random.default_rng(1).random((200, 1))
    points[100:150] = points[:50]  # requested again, by the next member
    requested = [names[(k + (k >= 100)) % 5] for k in range(200)]
    members = listened(requested, points)
    costs = np.random.default_rng(2).random(200)
    status = np.where(np.arange(200) % 7, OK, OK + 1).astype(np.uint8)
    every = Columns(points, costs[:, None], status, np.zeros(200), {})
    members.others = _Counted(members.others)
    rows = members.rows(every, methods())
    assert members.others.lookups == 200
    members.apart(every, methods(), names[1:])
    assert members.others.lookups == 400
    for row in rows:
        keys = {points[k].tobytes() for k in range(200) if requested[k] == row.member}
        ok = [costs[k] for k in range(200) if points[k].tobytes() in keys and status[k] == OK]
        assert row.best == min(ok)
        assert row.evaluations == sum(members.owner[point.tobytes()] == row.member for point in points)
