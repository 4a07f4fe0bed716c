"""The driver of systems with slots: any order of arrival, one record, and the same search when it is resumed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from campaigns.results.base import OK
from campaigns.stored.records import Ahead, Columns, StagePlan
from tests.given.at_night import nightly_but
from tests.simulators.threaded import Threaded, grid, threaded
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch, Floats, Minimum, Parallel, Several, Space
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Context, Driven
from worker.running.catalogue.installed import methods
from worker.running.runs.runner import Cancelled, ReplayMismatch
from worker.running.runs.store import MemoryStore

SEEDS = range(6)


@pytest.fixture(params=SEEDS)
def problem(request: pytest.FixtureRequest) -> Iterator[Problem]:
    with threaded(request.param) as made:
        yield made


def context(problem: Problem, store: MemoryStore | None = None, **changes: Any) -> Context:
    if store is None:
        store = MemoryStore()
        store.plan([StagePlan("search", "some", 10_000)])
    return Context(problem.campaign, problem, InProcess(problem), store, **changes)


def in_batches(points: list[Floats], seen: list[Batch]) -> Parallel:
    for part in points:
        batch = yield part
        seen.append(batch)
    return "requested everything"


def test_a_batch_has_the_order_of_its_request(problem: Problem) -> None:
    parts, seen = np.split(grid(60), [20, 23]), list[Batch]()
    driven = drive(context(problem), 0, in_batches(parts, seen), 1000)
    for part, batch in zip(parts, seen, strict=True):
        expected, _ = problem.evaluate(part)
        assert batch.costs.tobytes() == expected.costs.tobytes()
        assert batch.status.tolist() == expected.status.tolist()
    assert driven.columns is not None
    assert np.array_equal(driven.columns.points, grid(60))
    assert (driven.tally.evaluations, driven.tally.failed) == (60, int((driven.columns.status != OK).sum()))
    assert driven.columns.reasons.keys() == set(np.flatnonzero(driven.columns.status != OK).tolist())


def test_all_slots_are_used() -> None:
    for seed in SEEDS:
        with threaded(seed) as problem:
            drive(context(problem), 0, in_batches([grid(200)], []), 1000)
            assert isinstance(problem.system, Threaded)
            if problem.system.most >= problem.system.slots:
                return
    pytest.fail("the slots never had work at the same time")


def test_the_times_record_the_order_of_arrival(problem: Problem) -> None:
    columns = drive(context(problem), 0, in_batches([grid(50)], []), 1000).columns
    assert columns is not None
    assert len(set(columns.seconds.tolist())) == 50


@pytest.mark.parametrize("budget", [1, 20, 21, 59, 60])
def test_a_budget_is_used_exactly(budget: int) -> None:
    with threaded(1) as problem:
        driven = drive(context(problem), 0, in_batches(np.split(grid(60), [20, 23]), []), budget)
        assert isinstance(problem.system, Threaded)
        assert driven.stop == "budget"
        assert driven.tally.evaluations == problem.system.begun == budget


def searched(problem: Problem, name: str, store: MemoryStore | None = None, budget: int = 400) -> Driven:
    """A search by this method with the space that its stage makes."""
    method, minima = methods()[name], list[Minimum]()
    space = Space(
        dimension=2,
        budget=budget,
        random=np.random.default_rng(5),
        starts=np.empty((0, 2)),
        quantile=lambda u: u,
        report=minima.append,
        slots=problem.system.slots,
    )
    return drive(context(problem, store), 0, method.search(space, method.options()), budget, method.repeats)


def until(columns: Columns, moment: float) -> MemoryStore:
    """What was stored when the work was interrupted at this moment."""
    ended = columns.seconds <= moment
    done = len(ended) if ended.all() else int(np.argmin(ended))
    behind = np.array([i for i in np.flatnonzero(ended).tolist() if i >= done], dtype=np.int64)
    store = MemoryStore()
    store.plan([StagePlan("search", "some", 10_000)])
    store.append(0, 0, taken(columns, np.arange(done)), Ahead(behind, taken(columns, behind)))
    return store


def taken(columns: Columns, rows: Any) -> Columns:
    points, costs, status, seconds = (column[rows] for column in columns[:4])
    return Columns(points, costs, status, seconds, {i: why for i, why in columns.reasons.items() if i in set(rows)})


INTERRUPTED = ("sqp", "portfolio", "global_clustering", "hybrid_direct", "differential_evolution")


@pytest.mark.parametrize("name", nightly_but(("sqp", "portfolio", "differential_evolution"), INTERRUPTED))
def test_a_search_interrupted_at_any_moment_resumes_in_the_same_order(name: str) -> None:
    """All that had ended is used, nothing is evaluated twice, and what is requested follows from what had ended."""
    with threaded(2) as problem:
        whole = searched(problem, name).columns
    assert whole is not None
    for moment in np.quantile(whole.seconds, [0.02, 0.3, 0.65, 1.0], method="lower"):
        with threaded(7) as problem:
            assert isinstance(problem.system, Threaded)
            store = until(whole, moment)
            columns = searched(problem, name, store).columns
            ended = int((whole.seconds <= moment).sum())
            assert columns is not None
            assert problem.system.begun == len(columns.status) - ended
        before = whole.seconds <= moment
        known = np.flatnonzero(before)
        assert np.array_equal(columns.points[known], whole.points[known])
        assert columns.costs[known].tobytes() == whole.costs[known].tobytes()
        later = np.delete(columns.seconds, known)
        assert (later > moment).all(), "what ends now ends after all that had ended"
        if ended == len(whole.status):
            assert columns.points.tobytes() == whole.points.tobytes()
        rows = store.evaluations(0)
        assert rows is not None
        assert np.array_equal(rows.points, columns.points)
        assert store.ahead(0) is None


def test_what_no_longer_fits_the_record_is_refused() -> None:
    points, costs = grid(3)[1:], np.ones((2, 1))
    columns = Columns(points, costs, np.zeros(2, dtype=np.uint8), np.array([0.1, 0.2]), {})
    for requested, index in ((grid(60), "evaluation 4"), (grid(3), "evaluation 3")):
        store = MemoryStore()
        store.plan([StagePlan("search", "some", 100)])
        store.append(0, 0, taken(columns, []), Ahead(np.array([4, 5]), columns))
        with threaded(1) as problem, pytest.raises(ReplayMismatch, match=index):
            drive(context(problem, store), 0, in_batches([requested], []), 100)


def test_a_cancelled_stage_stores_what_had_ended() -> None:
    store = MemoryStore()
    store.plan([StagePlan("search", "some", 100)])
    with threaded(3) as problem:
        # The time of an evaluation is known as soon as some have ended: while no more than the first are handed out,
        # however long they take.
        assert problem.system.cost is None

        def cancelled() -> bool:
            return problem.system.cost is not None

        with pytest.raises(Cancelled):
            drive(context(problem, store, cancelled=cancelled), 0, in_batches([grid(5000)], []), 10_000)
        assert isinstance(problem.system, Threaded)
        begun = problem.system.begun
    rows, ahead = store.evaluations(0), store.ahead(0)
    count = (0 if rows is None else len(rows.status)) + (0 if ahead is None else len(ahead.indices))
    assert 0 < count <= begun < 5000


def test_groups_are_for_slots_only() -> None:
    def search() -> Parallel:
        yield Several([(0, grid(2))])
        return ""

    with threaded(3) as problem:
        system = problem.system
        assert isinstance(system, Threaded)
        system.slots = 0
        with pytest.raises(TypeError, match="a system without slots"):
            drive(context(problem), 0, search(), 10)
