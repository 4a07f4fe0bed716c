"""Whole runs: bit-identical for any number of threads, batch size and interruption."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.results.base import EXCLUDED
from tests.audited import audited
from tests.given.case_campaigns import searching
from tests.given.failing_stores import Interrupted, Unreliable, outcome
from tests.given.sampled_stages import DRAWN
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Floats
from worker.engine.stages.parts import driver
from worker.running.opening import opened
from worker.running.runs.runner import Cancelled, Tally, execute
from worker.running.runs.store import MemoryStore

SEARCHES = (
    {"method": "direct", "evaluations": 150},
    {"method": "sqp", "evaluations": 60, "starts": [{"vehicle.m": 4.5}, {"vehicle.m": 5.5, "vehicle.J": 0.048}]},
    {"method": "monte_carlo", "evaluations": 120},
)
QUICK = searching(*SEARCHES, scenario__horizon=1.0, stages__certify={"samples": 60})
"""One second of flight: a run takes no time."""


def run(asked: Campaign, threads: int = 1) -> Any:
    store = MemoryStore(sample_seed=DRAWN)
    conclusion = execute(asked, store, threads=threads)
    audited(store, asked)
    return outcome(store, conclusion)


class Ended(NamedTuple):
    """A run, and what it reported of each stage last."""

    store: MemoryStore
    outcome: Any
    progress: dict[int, Tally]


@pytest.fixture(scope="module")
def ended() -> Ended:
    told: dict[int, Tally] = {}
    store = MemoryStore(sample_seed=DRAWN)
    conclusion = execute(
        QUICK, store, progress=lambda position, tally: told.update({position: replace(tally)}), threads=1
    )
    audited(store, QUICK)
    return Ended(store, outcome(store, conclusion), told)


@pytest.fixture
def whole(ended: Ended) -> Any:
    return ended.outcome


def test_the_result_does_not_depend_on_the_threads(whole: Any) -> None:
    for threads in (2, 3):
        assert run(QUICK, threads) == whole


AT_NIGHT = (1, 2, 100, 161, 180, 225, 340)
"""By day where the first search begins, in the sample and in the validation; test_same_numbers.py has further ones."""


@pytest.mark.by_day(1)
@pytest.mark.parametrize("k", [11, 360, 402, *(pytest.param(k, marks=pytest.mark.nightly) for k in AT_NIGHT)])
def test_a_run_interrupted_anywhere_ends_as_if_it_had_not_been(
    k: int, whole: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driver, "FLUSH_ROWS", 7)
    flown: list[int] = []
    fly = Problem.evaluate

    def counted(problem: Problem, points: Floats, seeds: Any = None) -> Any:
        flown.append(len(points))
        return fly(problem, points, seeds)

    monkeypatch.setattr(Problem, "evaluate", counted)
    store = Unreliable(k)
    with pytest.raises(Interrupted):
        execute(QUICK, store, threads=1)
    held = sum(len(c.status) for chunks in store.chunks.values() for c in chunks)
    assert held == sum(flown) >= k
    conclusion = execute(QUICK, store, threads=1)
    assert outcome(store, conclusion) == whole
    assert sum(flown) == sum(len(c.status) for chunks in store.chunks.values() for c in chunks)


def test_a_finished_run_without_a_verdict_is_concluded_without_new_evaluations(
    ended: Ended, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = copy.deepcopy(ended.store)
    store.verdict = None
    monkeypatch.setattr(Problem, "evaluate", lambda *_: pytest.fail("everything is stored"))
    assert outcome(store, execute(QUICK, store, threads=1)) == ended.outcome


def test_a_run_is_cancelled_between_any_two_requests() -> None:
    store, asked = MemoryStore(sample_seed=DRAWN), []

    def cancelled() -> bool:
        asked.append(True)
        return len(asked) > 30

    with pytest.raises(Cancelled):
        execute(QUICK, store, cancelled=cancelled, threads=1)
    assert store.verdict is None
    assert store.stages[2].state == "running"


def test_progress_is_reported(ended: Ended) -> None:
    store = ended.store
    assert {p: t.evaluations for p, t in ended.progress.items()} == {
        p: len(c.status) for p in range(len(store.stages)) if (c := store.evaluations(p)) is not None
    }


@pytest.mark.parametrize("count", [1, 15, 16, 17, 33, 100])
def test_bits_do_not_depend_on_the_batch(count: int) -> None:
    problem = opened.problem(QUICK)
    points = np.random.default_rng(1).random((100, 2))
    alone = problem.evaluate(points[:1])[0].costs
    evaluate = InProcess(problem, 3)
    try:
        batch, reasons = evaluate(points[:count])
    finally:
        evaluate.close()
    assert batch.costs[:1].tobytes() == alone.tobytes()
    assert batch.costs.tobytes() == problem.evaluate(points)[0].costs[:count].tobytes()
    assert reasons == {}


def test_reasons_keep_their_rows_over_threads() -> None:
    uncertain = {"start.x": {"low": 0.0, "high": 4.0}, "start.y": {"low": 0.0, "high": 4.0}}
    problem = opened.problem(searching({"method": "direct", "evaluations": 1}, uncertain=uncertain))
    points = np.random.default_rng(1).random((200, 2)) * 0.1
    inside = [3, 64, 150, 199]
    points[inside] = 1.0  # on the obstacle
    evaluate = InProcess(problem, 3)
    try:
        batch, reasons = evaluate(points)
    finally:
        evaluate.close()
    assert sorted(reasons) == inside
    assert np.flatnonzero(batch.status == EXCLUDED).tolist() == inside
    assert " 0.5 m" in reasons[64]
