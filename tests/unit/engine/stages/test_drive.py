"""The driver between a method and its evaluations: budget, memory, storage, replay, interruption at any moment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from campaigns.claims.stages.ends import BUDGET
from campaigns.results.base import EXCLUDED, FAILED, OK, TIMEOUT
from campaigns.stored.records import Columns, StagePlan
from tests.given.case_campaigns import campaign, case1
from worker.engine.search.base import Batch, Floats, Search
from worker.engine.stages.parts import driver
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context, Driven
from worker.running.runs.runner import Cancelled, ReplayMismatch
from worker.running.runs.store import MemoryStore


class Counting:
    """No simulation: the cost is the sum of the coordinates; counts requests."""

    def __init__(self, status: Callable[[Floats], Any] | None = None) -> None:
        self.points: list[Floats] = []
        self.status = status

    def __call__(self, points: Floats) -> tuple[Batch, dict[int, str]]:
        self.points.append(points)
        status = np.zeros(len(points), dtype=np.uint8)
        if self.status is not None:
            status = np.asarray(self.status(points), dtype=np.uint8)
        costs = np.where(status == OK, points.sum(axis=1), np.nan)[:, None]
        return Batch(costs, status), {int(i): f"no {points[i, 0]:g}" for i in np.flatnonzero(status)}

    @property
    def count(self) -> int:
        return sum(map(len, self.points))


def context(evaluate: Counting, store: MemoryStore | None = None, **changes: Any) -> Context:
    """A stage over the given evaluations."""
    if store is None:
        store = MemoryStore()
        store.plan([StagePlan("search", "some", 100)])
    return Context(campaign(), case1(), evaluate, store, **changes)


def grid(first: int, count: int) -> Floats:
    return np.column_stack([np.arange(first, first + count), np.zeros(count)]).astype(float)


def in_batches(sizes: Sequence[int], seen: list[Batch] | None = None) -> Search:
    """Asks for consecutive points."""
    first = 0
    for size in sizes:
        batch = yield grid(first, size)
        if seen is not None:
            seen.append(batch)
        first += size
    return "asked for everything"


def test_a_search_that_ends_by_itself() -> None:
    evaluate, seen = Counting(), []
    made = context(evaluate)
    driven = drive(made, 0, in_batches([3, 5], seen), 100)
    assert (driven.stop, driven.how.text) == ("rule", "asked for everything")
    assert (driven.tally.evaluations, driven.tally.best, driven.tally.best_index) == (8, 0.0, 0)
    assert [len(b.status) for b in seen] == [3, 5]
    assert seen[1].costs[:, 0].tolist() == [3.0, 4.0, 5.0, 6.0, 7.0]
    assert driven.columns is not None
    assert driven.columns.points[:, 0].tolist() == list(range(8))
    assert made.columns[0] is driven.columns


@pytest.mark.parametrize("budget", [1, 3, 4, 7, 8, 9])
def test_the_budget_is_used_exactly_and_never_exceeded(budget: int) -> None:
    evaluate = Counting()
    driven = drive(context(evaluate), 0, in_batches([3, 5, 10]), budget)
    assert evaluate.count == driven.tally.evaluations == budget
    template = BUDGET if budget > 1 else "used its budget of {budget} evaluation"
    assert (driven.stop, driven.how.text) == ("budget", template.format(budget=budget))
    assert driven.columns is not None
    assert driven.columns.points[:, 0].tolist() == list(range(budget))


def test_a_search_is_closed_however_it_ends() -> None:
    closed = []

    def search() -> Search:
        try:
            while True:
                yield grid(0, 10)
        finally:
            closed.append(True)

    drive(context(Counting()), 0, search(), 25)
    with pytest.raises(Cancelled):
        drive(context(Counting(), cancelled=lambda: True), 0, search(), 25)

    def failing(points: Floats) -> Any:
        raise MemoryError

    with pytest.raises(MemoryError):
        drive(context(Counting(failing)), 0, search(), 25)
    assert len(closed) == 3


def repeating(seen: list[Batch]) -> Search:
    """Asks for the same points again and again, some twice in one batch."""
    for rows in ([0, 1, 2], [2, 1, 0], [3, 3, 0, 3], [0, 1]):
        batch = yield grid(0, 10)[rows]
        seen.append(batch)
    return "done"


def test_repeated_points_are_answered_from_memory_and_not_counted() -> None:
    evaluate, seen = Counting(lambda p: (p[:, 0] == 1) * FAILED), []
    driven = drive(context(evaluate), 0, repeating(seen), 100, repeats=True)
    assert [b.costs[:, 0].tolist() for b in seen[2:]] == [
        [3.0, 3.0, 0.0, 3.0],
        [0.0, pytest.approx(np.nan, nan_ok=True)],
    ]
    assert [b.status.tolist() for b in seen] == [[0, 1, 0], [0, 1, 0], [0] * 4, [0, 1]]
    assert all(b.costs.shape == (len(b.status), 1) and b.status.dtype == np.uint8 for b in seen)
    assert (driven.tally.evaluations, driven.tally.failed, evaluate.count) == (4, 1, 4)


def test_a_repeated_point_is_evaluated_again_for_a_method_that_does_not_repeat() -> None:
    driven = drive(context(Counting()), 0, repeating([]), 100)
    assert driven.tally.evaluations == 12


def test_the_budget_counts_evaluations_and_not_requests() -> None:
    seen: list[Batch] = []
    driven = drive(context(Counting()), 0, repeating(seen), 4, repeats=True)
    assert (driven.tally.evaluations, driven.stop) == (4, "budget")
    assert len(seen) == 2


def test_a_search_that_only_repeats_can_be_cancelled() -> None:
    requests = 0

    def forever() -> Search:
        nonlocal requests
        while True:
            requests += 1
            yield grid(0, 3)

    with pytest.raises(Cancelled):
        drive(context(Counting(), cancelled=lambda: requests > 50), 0, forever(), 100, repeats=True)


def test_failures_and_exclusions_are_counted() -> None:
    def status(points: Floats) -> Any:
        return np.choose(points[:, 0].astype(int) % 5, [FAILED, OK, TIMEOUT, EXCLUDED, OK])

    driven = drive(context(Counting(status)), 0, in_batches([3, 17]), 100)
    tally = driven.tally
    assert (tally.evaluations, tally.failed, tally.excluded) == (20, 8, 4)
    assert (tally.best, tally.best_index) == (1.0, 1)
    assert tally.best_point is not None
    assert tally.best_point.tolist() == [1.0, 0.0]
    assert driven.columns is not None
    assert sorted(driven.columns.reasons) == [i for i in range(20) if i % 5 in (0, 2, 3)]
    assert driven.columns.reasons[12] == "no 12"


def test_nothing_that_failed_is_ever_the_best() -> None:
    driven = drive(context(Counting(lambda p: np.full(len(p), EXCLUDED))), 0, in_batches([5]), 100)
    assert (driven.tally.best, driven.tally.best_index, driven.tally.best_point) == (None, None, None)


def test_results_are_stored_as_they_arise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "FLUSH_ROWS", 10)
    monkeypatch.setattr(driver, "FLUSH_SECONDS", 1e9)
    counts: list[int] = []
    made = context(Counting(), progress=lambda position, tally: counts.append(tally.evaluations))
    assert isinstance(made.store, MemoryStore)
    drive(made, 0, in_batches([4, 4, 4, 4, 4, 4]), 100)
    assert [len(c.status) for c in made.store.chunks[0]] == [12, 12]
    assert counts[:2] == [12, 24]
    seconds = made.store.evaluations(0)
    assert seconds is not None
    assert (np.diff(seconds.seconds) >= 0).all()


def test_long_requests_are_evaluated_in_pieces_so_that_they_are_stored_and_can_be_cancelled() -> None:
    evaluate = Counting()
    made = context(evaluate, cancelled=lambda: evaluate.count >= 2000)
    with pytest.raises(Cancelled):
        drive(made, 0, in_batches([10**6]), 10**6)
    assert 2000 <= evaluate.count < 200_000
    rows = made.store.evaluations(0)
    assert rows is not None
    assert len(rows.status) == evaluate.count


# Replay


def stored(count: int, position: int = 0) -> MemoryStore:
    """A store with the first evaluations of `in_batches`, one of which failed."""
    store = MemoryStore()
    store.plan([StagePlan("search", "some", 100)])
    points = grid(0, count)
    status = (points[:, 0] == 4).astype(np.uint8)
    costs = np.where(status == OK, points.sum(axis=1), np.nan)[:, None]
    reasons = {int(i): "no 4" for i in np.flatnonzero(status)}
    if count:
        store.append(position, 0, Columns(points, costs, status, np.linspace(0.1, 0.2, count), reasons))
    return store


def failing_at_4(points: Floats) -> Any:
    return (points[:, 0] == 4) * FAILED


@pytest.mark.parametrize("count", [0, 1, 3, 4, 8, 12, 18, 20])
def test_a_resumed_stage_evaluates_only_what_is_missing(count: int) -> None:
    whole = drive(context(Counting(failing_at_4)), 0, in_batches([3, 5, 10, 2]), 100)
    evaluate, seen, store = Counting(failing_at_4), [], stored(count)
    driven = drive(context(evaluate, store), 0, in_batches([3, 5, 10, 2], seen), 100)
    assert evaluate.count == 20 - count
    same(driven, whole)
    assert [len(b.status) for b in seen] == [3, 5, 10, 2]
    rows = store.evaluations(0)
    assert rows is not None
    assert np.array_equal(rows.points, grid(0, 20))
    assert (np.diff(rows.seconds) >= 0).all()
    assert rows.reasons == {4: "no 4"}


def same(one: Driven, other: Driven) -> None:
    """Everything but the time is the same, bit for bit."""
    assert one.how == other.how
    assert one.columns is not None
    assert other.columns is not None
    for k in (0, 1, 2):
        assert one.columns[k].tobytes() == other.columns[k].tobytes()
    assert one.columns.reasons == other.columns.reasons
    counts = [replace(d.tally, seconds=0.0, best_point=None) for d in (one, other)]
    assert counts[0] == counts[1]


def test_a_resumed_stage_uses_its_budget_exactly() -> None:
    evaluate = Counting(failing_at_4)
    driven = drive(context(evaluate, stored(10)), 0, in_batches([3, 5, 10, 2]), 15)
    assert (evaluate.count, driven.tally.evaluations, driven.stop) == (5, 15, "budget")


def test_a_stage_that_no_longer_asks_for_what_it_stored_is_refused() -> None:
    store = stored(8)

    def other() -> Search:
        yield grid(0, 3)
        yield grid(100, 5)
        return ""

    with pytest.raises(ReplayMismatch, match=r"stage 0 .* evaluation 3: "):
        drive(context(Counting(), store), 0, other(), 100)
    with pytest.raises(ReplayMismatch, match="evaluation 5"):
        drive(context(Counting(failing_at_4), store), 0, in_batches([5]), 100)


@pytest.mark.parametrize(
    ("cost", "lanes", "size"),
    [
        (None, None, 1),
        (None, 16, 256),
        (0.1, None, 2),
        (30.0, None, 1),
        (0.1, 16, 256),
        (1e-5, 16, 20_000),
        (1e-9, None, 65_536),
    ],
)
def test_a_batch_takes_no_longer_than_stored_rows_may_wait(
    cost: float | None, lanes: int | None, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A simulation of half a minute is stored, shown and cancelled one by one; a fast one is given whole blocks."""
    counting = Counting()
    stage = context(counting)
    system = stage.problem.system
    monkeypatch.setattr(system, "settings", replace(system.settings, lanes=lanes))
    monkeypatch.setattr(system, "cost", cost)
    drive(stage, 0, in_batches([70_000]), 70_000)
    assert len(counting.points[0]) == size
    assert counting.count == 70_000
    assert system.cost is not None
    assert 0.0 < system.cost < 1.0
