"""Portfolio: shares the budget by progress, attributes evaluations, stops unproductive members, visits both basins."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from clearance.testing.searching import Function, batch, run, space
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Batch, Floats
from worker.engine.search.methods import direct
from worker.engine.search.methods.portfolio import MEMBERS, Options, Part, Running, _turn, method
from worker.engine.search.parts.portfolio_record import APART, Record

NAMES = [part.method.name for part in MEMBERS]


def two_basins(x: Floats) -> Floats:
    """A slope with two equal failures, one the mirror of the other."""
    far = [np.sqrt(((x - centre) ** 2).sum(axis=1)) for centre in ([0.2, 0.3, 0.5], [0.8, 0.7, 0.5])]
    return np.asarray(np.minimum(*far).clip(max=0.15) * 10 - 1 + 0.1 * np.abs(x[:, 2] - 0.5))


def shared(function: Function, dimension: int, budget: int, seed: int = 1) -> list[tuple[str, Floats, Floats]]:
    """The requested points and their costs, by member and request."""
    told: list[tuple[str, int]] = []
    given = replace(space(dimension, budget, seed=seed), attribute=lambda member, count: told.append((member, count)))
    search, parts, asked = method.search(given, Options()), [], 0
    points = next(search)
    while asked < budget:
        values, at = function(points), 0
        for member, count in told:
            parts.append((member, points[at : at + count].copy(), values[at : at + count]))
            at += count
        assert at == len(points)
        told.clear()
        asked += at
        points = search.send(batch(values))
    search.close()
    return parts


def counted(parts: list[tuple[str, Floats, Floats]]) -> Counter[str]:
    count: Counter[str] = Counter()
    for member, points, _ in parts:
        count[member] += len(points)
    return count


def test_points_are_attributed_and_every_member_gets_its_share_of_the_budget() -> None:
    count = counted(shared(on_unit_cube("Levy 8", 1), 8, 3000))
    assert set(count) == set(NAMES)
    assert min(count.values()) > 60


def test_a_member_without_progress_is_starved() -> None:
    early = counted(shared(on_unit_cube("Ackley 10", 1), 10, 600))
    late = counted(shared(on_unit_cube("Ackley 10", 1), 10, 4000))
    gained = {name: late[name] - early[name] for name in NAMES}
    assert gained["cma_es"] > 4 * gained["global_clustering"]
    assert gained["cma_es"] > 700


def test_requests_are_shared() -> None:
    found = run(method, on_unit_cube("Hartman 6", 1), 6, 2000)
    assert len(found.points) / len(found.batches) > 3


def test_sqp_begins_at_the_lowest_point_of_all() -> None:
    """That was the lowest when its first request was made; it is evaluated at its turn."""
    parts = shared(on_unit_cube("Hartman 6", 1), 6, 400)
    first = next(i for i, (member, _, _) in enumerate(parts) if member == "sqp")
    before = [(p, v) for _, points, values in parts[:first] for p, v in zip(points, values, strict=True)]
    lows = [pair for i, pair in enumerate(before) if pair[1] == min(float(v) for _, v in before[: i + 1])]
    assert any(np.abs(parts[first][1] - low).max(axis=1).min() == 0.0 for low, _ in lows[1:])


def test_its_points_do_not_depend_on_the_budget() -> None:
    short, long = (run(method, two_basins, 3, budget).points for budget in (700, 1400))
    assert np.array_equal(short, long[: len(short)])
    assert method.extend is not None
    assert method.extend(Options(), 100) == Options()


def seeds(count: int) -> pytest.MarkDecorator:
    """The first seed by day, the others at night."""
    return pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.nightly) for k in range(1, count))])


@seeds(4)
def test_both_of_two_failures_are_reported(seed: int) -> None:
    found = run(method, two_basins, 3, 4000, seed=seed)
    for centre in ([0.2, 0.3, 0.5], [0.8, 0.7, 0.5]):
        assert any(np.abs(m.point - centre).max() < 0.01 and m.cost < -0.95 for m in found.minima)


@seeds(3)
@pytest.mark.parametrize(
    "name",
    ["Branin", "excluded region", *(pytest.param(n, marks=pytest.mark.nightly) for n in ("Shekel 10", "Griewank 5"))],
)
def test_the_known_minimum_is_found(name: str, seed: int) -> None:
    function = on_unit_cube(name, seed)
    assert function.gap(run(method, function, function.dimension, 5000, seed=seed, status=3).lowest) < 0.01


def test_a_member_that_ends_restarts_unless_it_would_repeat_itself() -> None:
    record, given = Record(2), space(2, 1000)
    once = Part(direct.method, direct.Options(iterations=1), 0.1, again=False)
    for part, anew in ((once, False), (replace(once, again=True), True)):
        member = Running(part, given, record)
        while member.ready() and member.used < 50:
            values = ((member.requested - 0.3) ** 2).sum(axis=1)
            member.tell(Batch(values[:, None], np.zeros(len(values), np.uint8)))
        assert (member.used >= 50) == anew


def test_turns_follow_the_shares() -> None:
    record, given = Record(2), space(2, 1000)
    members = [Running(Part(direct.method, direct.Options(), own), given, record) for own in (0.1, 0.1)]
    used = []
    for _ in range(60):
        for member in _turn(members, 10**9, ()):
            values = ((member.requested - 0.3) ** 2).sum(axis=1)
            member.tell(Batch(values[:, None], np.zeros(len(values), np.uint8)))
        used.append([m.used for m in members])
    assert all(abs(a - b) <= 120 for a, b in used)
    assert all(sum(later) > sum(earlier) for earlier, later in pairwise(used))


def test_starts_lie_apart_and_come_lowest_first() -> None:
    record = Record(2)
    assert record.start() is None
    random = np.random.default_rng(1)
    for _ in range(10):
        points = random.random((50, 2))
        record.see(points, np.where(points[:, 0] > 0.8, np.inf, points.sum(axis=1)))
    starts = [record.start() for _ in range(20)]
    found = np.array([s for s in starts if s is not None])
    assert len(found) == 20
    assert (found[:, 0] <= 0.8).all()
    assert (np.diff(found.sum(axis=1)) > 0).all()
    assert min(np.abs(found[i] - found[:i]).max(axis=1).min() for i in range(1, 20)) >= APART
    record.see(found[:1], np.array([-1.0]))
    assert record.lowest == -1.0
    assert record.lowest_start() > 0.0
