"""A worker: claims runs, keeps their leases alive, and has a child process do the work.

The supervisor never runs physics: whatever the child does (crash, hang, hold the interpreter), the lease is kept, a
cancel is obeyed within a second, and the run goes back to the queue. Start reading at `Supervisor.run`.
"""

from __future__ import annotations

import logging
import os
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db import workers
from backend.db.engine import connect, write
from backend.db.queue import LEASE, Claim, LostLease, Queue
from worker.processes.children import Child, ChildEndedError
from worker.processes.lifeline import Wakeup

log = logging.getLogger("clearance.worker")

POLL = 0.5
"""How often an idle worker looks for a run [s]."""

WATCH = 0.25
"""How often a working one looks whether its run is to be cancelled [s]."""

GRACE = 2.0
"""How long a child whose run has ended may take to say so before it is killed [s]."""

ANSWER = 10.0
"""How long an idle child may take to say whether its code is that of the files [s]."""

START = 300.0
"""How long a child may take to start [s]."""

MOST_FAILURES = 3
"""How many times in a row a child may fail to start before the worker ends, so that whoever started it is told."""

SETTLE = 60.0
"""How long the end of an attempt is written again while the database is away [s]; then its lease runs out anyway."""


@dataclass(frozen=True)
class Ending:
    """How an attempt ended: an outcome of `worker.processes.child`, or `died`, `cancelled`, `stopped`."""

    outcome: str
    text: str = ""


def default_name() -> str:
    """What a worker is called where it is given no name: machine and process."""
    return f"{socket.gethostname()}:{os.getpid()}"[:80]


class Supervisor:
    """One worker with one child; `runner` names what the child calls, as `module:function`."""

    def __init__(self, url: str, name: str, *, runner: str, lease: float = LEASE) -> None:
        self.url, self.name, self.runner = url, name, runner
        self.engine = connect(url)
        self.queue = Queue(self.engine, lease)
        self.child: Child | None = None
        self._wakeup = Wakeup()
        self._next_beat = 0.0
        self._failures = 0

    def run(self) -> int:
        """Work until SIGTERM, SIGINT or SIGHUP; returns the number of that signal."""
        with self._wakeup:
            try:
                self._patiently(lambda: self._tell(workers.arrive))
                while self._wakeup.signal is None:
                    self._patiently(self._turn)
            finally:
                self._drop_child()
                self._patiently(lambda: self._tell(workers.leave))
                self.engine.dispose()
        return self._wakeup.signal or 0

    def _turn(self) -> None:
        """Take one run from its claim to its end, or wait a little."""
        self._beat_idle()
        child = self._ready_child()
        if child is None or self._wakeup.signal is not None:
            return
        claim = self.queue.claim(self.name)
        if claim is None:
            self._wakeup.wait(POLL)
            return
        log.info("run %d: attempt %d of %d", claim.run_id, claim.attempt, claim.max_attempts)
        ending = self._watch(child, claim)
        log.info("run %d: %s%s", claim.run_id, ending.outcome, ending.text and f" ({ending.text})")
        self._settle(claim, ending)

    def _watch(self, child: Child, claim: Claim) -> Ending:
        """Beat while the child works; returns once it no longer does."""
        try:
            child.send(claim.as_json())
            while True:
                answer = child.receive(WATCH)
                if answer is not None:
                    return Ending(answer["outcome"], answer["text"])
                if self._wakeup.signal is not None:
                    self._drop_child()
                    return Ending("stopped")
                if self._asked_to_cancel(claim):
                    self._drop_child()
                    return Ending("cancelled")
        except ChildEndedError as ended:
            self.child = None
            return Ending("died", f"the worker process {ended}")
        except LostLease:
            return self._lost(child)

    def _asked_to_cancel(self, claim: Claim) -> bool:
        try:
            due = time.monotonic() >= self._next_beat
            if not due and not self.queue.cancel_requested(claim):
                return False
            self._next_beat = time.monotonic() + self.queue.lease / 5
            cancelling = self.queue.beat(claim)
            self._tell(workers.beat, claim.run_id)
            return cancelling
        except sa.exc.OperationalError as error:
            log.warning("run %d: heartbeat failed, the database did not answer: %s", claim.run_id, error.orig)
            return False

    def _lost(self, child: Child) -> Ending:
        """The run is no longer ours: it has just ended, or another worker has it. A child that says so stays warm."""
        try:
            answer = child.receive(GRACE)
        except ChildEndedError:
            answer = None
        if answer is None:
            self._drop_child()
        return Ending(answer["outcome"] if answer and answer["outcome"] == "done" else "lost")

    def _settle(self, claim: Claim, ending: Ending) -> None:
        """Write how the attempt ended."""
        queue = self.queue
        settle: dict[str, Callable[[], None]] = {
            "died": lambda: queue.retry(claim, ending.text),
            "failed": lambda: queue.retry(claim, ending.text),
            "unusable": lambda: queue.fail(claim, ending.text),
            "cancelled": lambda: queue.cancelled(claim),
            "stopped": lambda: queue.give_back(claim),
            "stale": lambda: queue.give_back(claim),
        }
        if ending.outcome not in settle:
            return
        deadline = time.monotonic() + (SETTLE if self._wakeup.signal is None else 1.0)
        while True:
            try:
                settle[ending.outcome]()
                return
            except LostLease:
                log.info("run %d: was reassigned to another worker", claim.run_id)
                return
            except sa.exc.OperationalError as error:
                if time.monotonic() > deadline:
                    log.warning("run %d: left until its lease expires: %s", claim.run_id, error.orig)
                    return
            self._wakeup.wait(0.2)

    def _ready_child(self) -> Child | None:
        """The child, started where there is none or the code has changed; None when it did not come up (it is tried
        again).
        """
        if self.child is not None and self.child.alive() and self._is_fresh(self.child):
            return self.child
        self._drop_child()
        child = self.child = Child({"database": self.url, "runner": self.runner}, self._wakeup)
        deadline = time.monotonic() + START
        try:
            while self._wakeup.signal is None and time.monotonic() < deadline:
                answer = child.receive(WATCH)
                if answer is not None:
                    self._failures = 0
                    return child if answer["fresh"] else None
                self._beat_idle()
            how = f"did not start within {START:g} s"
        except ChildEndedError as ended:
            how = str(ended)
        self._drop_child()
        if self._wakeup.signal is None:
            self._failures += 1
            if self._failures >= MOST_FAILURES:
                raise RuntimeError(f"the worker process {how} before it was ready, {self._failures} times in a row")
            log.error("the worker process %s before it was ready; it is started again", how)
            self._wakeup.wait(0.5 * 2**self._failures)
        return None

    def _is_fresh(self, child: Child) -> bool:
        """Whether the code that the child loaded is still that of the files, as it says itself: it knows which."""
        deadline = time.monotonic() + ANSWER
        try:
            child.send({"fresh": True})
            while self._wakeup.signal is None and time.monotonic() < deadline:
                answer = child.receive(WATCH)
                if answer is not None:
                    if not answer["fresh"]:
                        log.info("the code has changed: another process loads it")
                    return bool(answer["fresh"])
        except ChildEndedError as ended:
            log.error("the worker process %s while it was idle; it is started again", ended)
        return self._wakeup.signal is not None

    def _drop_child(self) -> None:
        if self.child is not None:
            self.child.kill()
            self.child = None

    def _beat_idle(self) -> None:
        if time.monotonic() >= self._next_beat:
            self._next_beat = time.monotonic() + self.queue.lease / 5
            self._tell(workers.beat, None)

    def _tell(self, what: Callable[..., None], *values: int | None) -> None:
        write(self.engine, lambda connection: what(connection, self.name, *values), 0.0)

    def _patiently(self, work: Callable[[], None]) -> None:
        try:
            work()
        except sa.exc.OperationalError as error:
            log.warning("the database does not answer: %s", error.orig)
            self._wakeup.wait(1.0)
