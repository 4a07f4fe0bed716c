"""The pool of a cluster on a client that fails as asked: what becomes of a batch whose task did not end well."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from distributed import KilledWorker
from distributed.client import FutureCancelledError

from worker.engine.systems.simulators.cluster import connection as connections
from worker.engine.systems.simulators.cluster import pool as pools
from worker.engine.systems.simulators.cluster.address import Evaluator, EvaluatorLost
from worker.engine.systems.simulators.cluster.pool import DaskPool
from worker.engine.systems.simulators.cluster.work import (
    Done,
    Files,
    NodeClosing,
    NodeUnusable,
    Work,
    changed,
    check,
    code,
    forget,
)
from worker.engine.systems.simulators.declared import unchanged
from worker.engine.systems.simulators.declared.folder import digest_of, digest_of_place
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome
from worker.engine.systems.simulators.slots.program import Program

Task = Callable[[list[int]], Done]
"""What a task does with its batch."""


class Fake:
    """A connection and its client; `task` carries out every task, `batches` has what they were sent."""

    def __init__(self, threads: int) -> None:
        self.threads, self.ahead = threads, 0
        self.evaluator = Evaluator("dask://fake:1")
        self.changed: list[Any] = []
        self.lost: list[Any] = []
        self.keys: set[str] = set()
        self.connected: Fake | None = self
        self.task: Task = evaluated
        self.batches: list[list[int]] = []
        self.running = self.most = 0
        self.open_gate = threading.Event()
        self.open_gate.set()
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()

    def call(self, work: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(work, self.loop).result()

    async def open(self) -> None:
        pass

    async def client(self) -> Fake:
        return self

    async def run(self, function: object, *given: object, **options: Any) -> None:
        pass

    async def submit(self, function: object, work: Work, requests: Sequence[Any], **options: Any) -> Done:
        batch = [r["k"] for r in requests]
        self.batches.append(batch)
        self.running += 1
        self.most = max(self.most, self.running)
        try:
            while not self.open_gate.is_set():
                await asyncio.sleep(0.001)
            await asyncio.sleep(0)
            return self.task(batch)
        finally:
            self.running -= 1

    def close(self) -> None:
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()
        self.loop.close()


def evaluated(batch: list[int], each: float = 0.01) -> Done:
    return Done([Outcome("ok", k) for k in batch], each * len(batch))


def killed(runs: int) -> KilledWorker:
    return KilledWorker("evaluate", SimpleNamespace(address="tcp://10.0.0.3:4000"), runs - 1)


@pytest.fixture
def cluster(monkeypatch: pytest.MonkeyPatch) -> Iterator[Fake]:
    made = Fake(2)
    monkeypatch.setattr(connections, "acquire", lambda evaluator: made)
    monkeypatch.setattr(connections, "release", lambda connection: None)
    yield made
    made.close()


@pytest.fixture
def pool(cluster: Fake) -> Iterator[DaskPool]:
    with DaskPool(cluster.evaluator, Program(["true"], "lines"), Limits(), Files("/", "")) as made:
        yield made


def requests(count: int) -> list[dict[str, int]]:
    return [{"k": k} for k in range(count)]


def answers(outcomes: list[Outcome]) -> list[Any]:
    return [o.answer for o in outcomes]


def submitted(cluster: Fake, pool: DaskPool, count: int) -> list[Future[Outcome]]:
    """All at once: nothing ends before the last one was submitted."""
    cluster.open_gate.clear()
    futures = [pool.submit(r) for r in requests(count)]
    cluster.open_gate.set()
    return futures


def test_a_task_takes_as_many_as_last_the_target_and_no_more_than_its_part(cluster: Fake, pool: DaskPool) -> None:
    pool.evaluate(requests(50))
    cluster.batches.clear()
    assert answers([f.result(timeout=10) for f in submitted(cluster, pool, 200)]) == list(range(200))
    longest = max(map(len, cluster.batches))
    assert 10 < longest <= pools.TARGET / 0.01 + 1
    assert cluster.most <= cluster.threads


def test_a_slow_simulator_has_a_task_for_each_evaluation(cluster: Fake, pool: DaskPool) -> None:
    cluster.task = lambda batch: evaluated(batch, 0.3)
    pool.evaluate(requests(20))
    assert {len(batch) for batch in cluster.batches} == {1}


def test_what_a_task_did_not_begin_is_sent_again(cluster: Fake, pool: DaskPool) -> None:
    cluster.task = lambda batch: evaluated(batch[: (len(batch) + 1) // 2])
    assert answers(pool.evaluate(requests(300))) == list(range(300))
    assert sorted({k for batch in cluster.batches for k in batch}) == list(range(300))


@pytest.mark.parametrize(("runs", "times"), [(1, 3), (4, 4)])
def test_of_a_batch_whose_node_died_only_the_one_at_fault_fails(
    cluster: Fake, pool: DaskPool, runs: int, times: int
) -> None:
    """Each of the batch is sent alone, one at a time; runs: those that the scheduler made by itself."""
    pool.evaluate(requests(50))
    cluster.batches.clear()

    def task(batch: list[int]) -> Done:
        if 13 in batch:
            raise killed(runs)
        return evaluated(batch)

    cluster.task = task
    outcomes = [f.result(timeout=10) for f in submitted(cluster, pool, 60)]
    assert [k for k, o in enumerate(outcomes) if o.kind != "ok"] == [13]
    assert outcomes[13].kind == "crash"
    assert f" {times} times; " in outcomes[13].sentence
    assert outcomes[13].sentence.endswith(" tcp://10.0.0.3:4000")
    assert len([batch for batch in cluster.batches if batch == [13]]) >= times // runs


@pytest.mark.parametrize(
    "error", [FutureCancelledError("key", "scheduler-connection-lost"), OSError("closed"), NodeClosing("node")]
)
def test_what_a_lost_scheduler_or_a_closing_node_had_is_sent_again(
    cluster: Fake, pool: DaskPool, error: Exception
) -> None:
    left = [error] * 5

    def task(batch: list[int]) -> Done:
        if left:
            raise left.pop()
        return evaluated(batch)

    cluster.task = task
    assert answers(pool.evaluate(requests(30))) == list(range(30))


def test_any_other_error_ends_everything_with_a_sentence(cluster: Fake, pool: DaskPool) -> None:
    lost = ModuleNotFoundError("No module named 'worker'")

    def task(batch: list[int]) -> Done:
        raise lost

    cluster.task = task
    futures = submitted(cluster, pool, 30)
    errors = {str(f.exception(timeout=10)) for f in futures}
    assert errors == {f"evaluator dask://fake:1: ModuleNotFoundError: {lost}"}
    with pytest.raises(EvaluatorLost):
        pool.submit({"k": 1})


def test_an_error_of_a_connection_that_was_lost_is_not_one_of_the_evaluation(cluster: Fake, pool: DaskPool) -> None:
    left = [AttributeError("'NoneType' object has no attribute 'submit'")] * 3

    def task(batch: list[int]) -> Done:
        if left:
            cluster.connected = None
            raise left.pop()
        return evaluated(batch)

    cluster.task = task
    assert answers(pool.evaluate(requests(30))) == list(range(30))


def test_losing_the_cluster_ends_what_runs_and_what_waits(cluster: Fake, pool: DaskPool) -> None:
    cluster.open_gate.clear()
    futures = [pool.submit(r) for r in requests(30)]
    lost = EvaluatorLost("it had no worker")
    cluster.loop.call_soon_threadsafe(cluster.lost[0], lost)
    assert {str(f.exception(timeout=10)) for f in futures} == {str(lost)}
    cluster.open_gate.set()


def test_a_cancelled_evaluation_disturbs_no_other(cluster: Fake, pool: DaskPool) -> None:
    cluster.open_gate.clear()
    futures = [pool.submit(r) for r in requests(30)]
    assert futures[7].cancel()
    cluster.open_gate.set()
    assert [f.result(timeout=10).answer for k, f in enumerate(futures) if k != 7] == [k for k in range(30) if k != 7]


def test_many_threads_may_submit_and_one_may_close(cluster: Fake, pool: DaskPool) -> None:
    taken: list[Future[Outcome]] = []

    def submit() -> None:
        for k in range(200):
            try:
                taken.append(pool.submit({"k": k}))
            except RuntimeError:
                return

    threads = [threading.Thread(target=submit, daemon=True) for _ in range(4)]
    for thread in threads:
        thread.start()
    pool.close()
    for thread in threads:
        thread.join()
    assert {f.result(timeout=10).kind for f in taken} <= {"ok", "not started"}


def test_a_node_whose_files_changed_is_named_by_the_pool(
    cluster: Fake, pool: DaskPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = {"tcp://a": "", "tcp://b": ""}

    async def run(function: object, *given: object, **options: Any) -> dict[str, str]:
        assert function is changed
        return found

    monkeypatch.setattr(cluster, "run", run)
    assert pool.changed() == ""
    found["tcp://b"] = "node b: s.py has changed"
    assert pool.changed() == "node b: s.py has changed"


def test_nodes_that_do_not_answer_are_no_evidence(
    cluster: Fake, pool: DaskPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def run(function: object, *given: object, **options: Any) -> None:
        if function is changed:
            await asyncio.Event().wait()

    monkeypatch.setattr(cluster, "run", run)
    monkeypatch.setattr(pools, "ANSWER", 0.01)
    with pytest.raises(EvaluatorLost, match=r"not answer within 0\.01 s"):
        pool.changed()


@pytest.mark.parametrize("place", [{}, {"name": "f"}])
def test_a_node_compares_its_files_again_and_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: dict[str, str]
) -> None:
    monkeypatch.setattr(unchanged, "PAUSE", 0.0)
    monkeypatch.setattr(unchanged, "LEISURE", 0.0)
    file = tmp_path / "s.py"
    file.write_text("X = 1\n")
    place = place and {**place, "file": str(file)}
    files = Files(str(tmp_path), digest_of_place(place) if place else digest_of(tmp_path), place)
    work = Work("changing", Program(["true"], "lines"), Limits(), files, code=code())
    check(work)
    check(work)
    assert changed(work.key, now=True) == ""
    file.write_text("X = 2\n")
    for _ in range(2):
        with pytest.raises(NodeUnusable, match=r"node .*: s\.py has changed"):
            check(work)
    assert "s.py has changed" in changed(work.key, now=True)
    forget(work.key)
    assert changed(work.key, now=True) == ""
    with pytest.raises(NodeUnusable, match="has other files"):
        check(work)
