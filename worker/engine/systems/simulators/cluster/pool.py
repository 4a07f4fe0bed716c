"""Slots on the nodes of a cluster, with the interface of `SlotPool`: batches of evaluations as tasks of Dask.

A task evaluates as many requests as take about `TARGET`. Whatever becomes of a task, each of its evaluations ends once:
with an outcome, sent again, or with `EvaluatorLost`.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import math
import threading
import uuid
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from distributed import KilledWorker

from worker.engine.systems.simulators.cluster import connection as connections
from worker.engine.systems.simulators.cluster import node
from worker.engine.systems.simulators.cluster.address import Evaluator, EvaluatorLost
from worker.engine.systems.simulators.cluster.work import Done, Files, NodeClosing, NodeUnusable, Work, changed, code
from worker.engine.systems.simulators.slots.outcome import Limits, Outcome, Request, Slots
from worker.engine.systems.simulators.slots.program import Program

TARGET = 0.2
"""A task should take so long [s]: one costs 2 to 4 ms."""
MOST = 4096
"""Evaluations in one task."""
DEATHS = 3
"""An evaluation fails after so many nodes died while they evaluated it alone."""
END = 5.0
"""Time for the nodes to close slots [s]."""
ANSWER = 60.0
"""Time for the nodes to look at their files [s]."""


@dataclass
class _Job:
    request: Request
    future: Future[Outcome]
    suspect: bool = False
    deaths: int = 0
    """Nodes that died while they evaluated it alone."""


class DaskPool(Slots):
    """Evaluates a program on a cluster.

    program: its folder may contain `WORK`; files: those of the simulator, the same on every node.
    Raises `EvaluatorLost` when the cluster cannot be reached.
    """

    def __init__(self, evaluator: Evaluator, program: Program, limits: Limits, files: Files) -> None:
        self.sent = 0
        """Number of tasks that were sent."""
        self._work = Work(uuid.uuid4().hex, program, limits, files, code=code())
        self._lock = threading.Lock()
        self._arrived: deque[_Job] = deque()
        self._due = False
        self._closed = ""
        self._waiting: deque[_Job] = deque()
        self._suspects: deque[_Job] = deque()
        """Their node died; they run one at a time, so that no other is blamed."""
        self._running: dict[asyncio.Task[None], list[_Job]] = {}
        self._mean = math.inf
        self._failure: EvaluatorLost | None = None
        self._connection = connections.acquire(evaluator)
        try:
            self._connection.call(self._connection.client())
        except BaseException:
            connections.release(self._connection)
            raise
        self._connection.changed.append(self._hand_out)
        self._connection.lost.append(self._fail)
        self._connection.keys.add(self._work.key)

    @property
    def size(self) -> int:
        """Evaluations side by side: as stated with the address, or threads of the cluster now."""
        return self._connection.evaluator.slots or max(1, self._connection.threads)

    def submit(self, request: Request) -> Future[Outcome]:
        """Queue one evaluation; raises RuntimeError once closed, `EvaluatorLost` once the cluster counts as lost."""
        future: Future[Outcome] = Future()
        with self._lock:
            if self._failure is not None:
                raise self._failure
            if self._closed:
                raise RuntimeError(f"the slots are closed: {self._closed}")
            self._arrived.append(_Job(request, future))
            if not self._due:
                self._due = True
                self._connection.loop.call_soon_threadsafe(self._arrive)
        return future

    def changed(self) -> str:
        """A sentence on a node whose files are no longer those that it compared; empty if there is none.

        It does not know of nodes that have left. Raises `EvaluatorLost` if the nodes do not answer.
        """
        try:
            found = self._connection.call(asyncio.wait_for(self._node_changes(), ANSWER))
        except TimeoutError:
            raise EvaluatorLost(
                f"evaluator {self._connection.evaluator.address}: its nodes did not answer within {ANSWER:g} s whether "
                "their files are as they were; start the run again"
            ) from None
        return next(filter(None, found.values()), "")

    async def _node_changes(self) -> dict[str, str]:
        client = await self._connection.client()
        found: dict[str, str] = await client.run(changed, self._work.key, now=True, on_error="ignore")
        return found

    def close(self) -> None:
        with self._lock:
            if self._closed:
                return
            self._closed = "cancelled"
        self._connection.call(self._end())
        connections.release(self._connection)

    def _arrive(self) -> None:
        with self._lock:
            self._due = False
            self._waiting.extend(self._arrived)
            self._arrived.clear()
        if self._failure is not None:
            self._fail(self._failure)
        self._hand_out()

    def _hand_out(self) -> None:
        """Send what the cluster has room for: even parts, none longer than the target."""
        if self._closed or self._failure is not None:
            return
        if self._suspects and not any(batch[0].suspect for batch in self._running.values()):
            self._begin([self._suspects.popleft()])
        while self._waiting:
            room = self._connection.threads + self._connection.ahead - len(self._running)
            if room <= 0:
                return
            even = math.ceil(len(self._waiting) / room)
            count = min(even, MOST, max(1, int(TARGET / self._mean)))
            self._begin([self._waiting.popleft() for _ in range(count)])

    def _begin(self, batch: list[_Job]) -> None:
        self.sent += 1
        task = self._connection.loop.create_task(self._send(batch))
        self._running[task] = batch

        def ended(task: asyncio.Task[None]) -> None:
            self._running.pop(task, None)
            self._hand_out()

        task.add_done_callback(ended)

    async def _send(self, batch: list[_Job]) -> None:
        """Carry out one task."""
        requests, client = [job.request for job in batch], None
        try:
            client = await self._connection.client()
            done = await client.submit(node.evaluate, self._work, requests, pure=False, retries=0)
        except KilledWorker as error:
            self._killed(batch, error)
        except (concurrent.futures.CancelledError, OSError, TimeoutError, NodeClosing):
            self._again(batch)  # the scheduler died, or the node is shutting down
        except EvaluatorLost as error:
            self._again(batch)
            self._fail(error)
        except Exception as error:
            self._again(batch)
            if client is not None and self._connection.connected is not client:
                return  # whatever the error, the connection was lost
            self._fail(EvaluatorLost(f"evaluator {self._connection.evaluator.address}: {_statement(error)}"))
        else:
            self._deliver(batch, done)

    def _deliver(self, batch: list[_Job], done: Done) -> None:
        each = max(done.seconds / len(done.outcomes), 1e-6)
        self._mean = each if math.isinf(self._mean) else self._mean + 0.3 * (each - self._mean)
        for job, outcome in zip(batch, done.outcomes, strict=False):
            _finish(job, outcome)
        self._again(batch[len(done.outcomes) :])

    def _again(self, batch: Sequence[_Job]) -> None:
        """Send these before others."""
        for job in reversed(batch):
            (self._suspects if job.suspect else self._waiting).appendleft(job)

    def _killed(self, batch: list[_Job], error: KilledWorker) -> None:
        """Their node died: find the one at fault among them, or let it fail."""
        runs = error.allowed_failures + 1
        for job in batch:
            if job.suspect:
                job.deaths += runs
            job.suspect = True
            if job.deaths < DEATHS:
                self._suspects.append(job)
                continue
            last = f"the last one was {error.last_worker.address}"
            reason = f"a node died while evaluating this, {job.deaths} times; {last}"
            _finish(job, Outcome("crash", None, reason))

    def _fail(self, error: EvaluatorLost) -> None:
        """Give up: everything that has not ended ends with this error."""
        with self._lock:
            self._failure = self._failure or error
        for job in self._left():
            if job.future.set_running_or_notify_cancel():
                job.future.set_exception(self._failure)

    def _left(self) -> list[_Job]:
        """Take all evaluations that have not ended, and cancel the tasks."""
        with self._lock:
            found = [job for batch in self._running.values() for job in batch if not job.future.done()]
            found += [job for jobs in (self._suspects, self._waiting, self._arrived) for job in jobs]
            for jobs in (self._suspects, self._waiting, self._arrived):
                jobs.clear()
        for task in self._running:
            if task is not asyncio.current_task():
                task.cancel()
        self._running.clear()
        return list({id(job): job for job in found}.values())

    async def _end(self) -> None:
        self._connection.changed.remove(self._hand_out)
        self._connection.lost.remove(self._fail)
        self._connection.keys.discard(self._work.key)
        tasks = list(self._running)
        left = self._left()
        await asyncio.gather(*tasks, return_exceptions=True)
        client = self._connection.connected
        if client is not None:
            with contextlib.suppress(Exception):
                release = client.run(node.release, self._work.key, on_error="ignore")
                await asyncio.wait_for(release, END)
        for job in left:
            _finish(job, Outcome("not started", reason=self._closed))


def _finish(job: _Job, outcome: Outcome) -> None:
    if not job.future.done() and job.future.set_running_or_notify_cancel():
        job.future.set_result(outcome)


def _statement(error: Exception) -> str:
    """What went wrong on a node, in one line."""
    text = " ".join(str(error).split())[:400]
    return text if isinstance(error, NodeUnusable) else f"{type(error).__name__}: {text}"
