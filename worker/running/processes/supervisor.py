"""A worker: claims runs, renews their leases, and executes them in a child process.

The supervisor never simulates. Whatever the child does (crash, hang, hold the interpreter), the lease is renewed, a
cancellation takes effect within a second, and the run returns to the queue. Start reading at `Supervisor.run`.
"""

from __future__ import annotations

import logging
import math
import os
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa

from backend.db import space, workers
from backend.db.engine import connect, write
from backend.db.outages import worded
from backend.db.queue import LEASE, Claim, LostLease, Queue
from campaigns import logs
from campaigns.runs import run_name
from worker.engine.systems.simulators.slots import marks, places
from worker.running.processes import standstill
from worker.running.processes.children import Child, ChildEndedError
from worker.running.processes.lifeline import Wakeup
from worker.running.processes.standstill import Standstill
from worker.running.processes.watching import Watch

log = logging.getLogger("clearance.worker")

POLL = 0.5
"""Interval at which an idle worker polls for a run [s]."""

WATCH = 0.25
"""Interval at which a busy worker checks for cancellation [s]."""

GRACE = 2.0
"""Time for a child to report the end of its run after the lease was lost, before it is killed [s]."""

ANSWER = 10.0
"""Time for an idle child to report whether its code still equals the files [s]."""

START = 300.0
"""Time for a child to start [s]."""

MOST_FAILURES = 3
"""Consecutive failures of a child to start after which the worker exits with an error."""

SETTLE = 60.0
"""Time for which writing the end of an attempt is retried while the database is unavailable; then its lease expires."""

REST, LONGEST_REST = 5.0, 600.0
"""Time after which a worker assists a run again that had nothing left for it, or failed in its process [s]."""

UNSTORED = "How its attempt ended could not be stored: the log of its worker has the reason"

PUT_OFF = 5.0
"""Time after which a run is tried again that a database out of order has ended [s]."""


@dataclass(frozen=True)
class Ending:
    """How an attempt ended: an outcome of `worker.running.processes.child`, or `died`, `killed`, `cancelled`,
    `stopped`."""

    outcome: str
    text: str = ""


def default_name() -> str:
    """The default name of a worker: host name and process id."""
    return f"{socket.gethostname()}:{os.getpid()}"[:80]


class Rest(NamedTuple):
    """Until when a run is not assisted [s of the monotonic clock], and for how long [s]."""

    until: float
    pause: float


class Supervisor:
    """One worker with one child.

    runner: the function that the child calls, as `module:function`; standstill: how long it may always be without a
    new result [s]; data: the data folder, if it has one.
    """

    def __init__(
        self,
        url: str,
        name: str,
        *,
        runner: str,
        lease: float = LEASE,
        standstill: float = standstill.FLOOR,
        data: Path | None = None,
    ) -> None:
        self.url, self.name, self.runner = url, name, runner
        self._room = space.Room(space.places(url, data), space.limit_of(os.environ))
        self.engine = connect(url, create=False)
        self.queue = Queue(self.engine, lease)
        self._floor = standstill
        self.child: Child | None = None
        self._wakeup = Wakeup()
        setup = {"database": url, "runner": runner, "worker": name}
        self._files = Watch(lambda: Child(setup, self._wakeup))
        self.simulators: list[str] = []
        """The simulators that were published last."""
        self.installation = ""
        """Digest of the code that the child has loaded."""
        self.drained = False
        """Whether it was asked to take no further run."""
        self._outage = False
        """Whether the last heartbeat of a run could not be stored."""
        self._next_beat = 0.0
        self._failures = 0
        self._resting: dict[int, Rest] = {}
        """The runs that this worker has assisted, by their numbers."""

    def run(self) -> int:
        """Process runs until SIGTERM, SIGINT or SIGHUP; returns the number of that signal, or 0 once it is drained."""
        logs.present["worker"] = self.name
        marks.end_orphans()
        places.remove_left()
        with self._wakeup:
            try:
                self._despite_outage(lambda: self._notify(workers.arrive))
                while self._wakeup.signal is None and not self.drained:
                    self._despite_outage(self._turn)
            finally:
                self._drop_child()
                self._despite_outage(lambda: self._notify(workers.leave))
                self.engine.dispose()
        return self._wakeup.signal or 0

    def _turn(self) -> None:
        """Process one run from its claim to its end, or wait for the next poll."""
        self._beat_due(None)
        child = self._ready_child()
        if child is None or self._wakeup.signal is not None or self.drained:
            return
        if self._short:  # without the changing number, so that it is one line a minute
            log.warning("no further run is begun: less than %s bytes are free (%s)", self._room.limit, space.VARIABLE)
            self._wakeup.wait(POLL)
            return
        claim = self.queue.claim(self.name, self.simulators, self.installation)
        if claim is None:
            if not self._assist(child):
                self._wakeup.wait(POLL)
            return
        logs.present["run"] = run_name(claim.run_id)
        log.info("run %d: attempt %d of %d", claim.run_id, claim.attempt, claim.max_attempts)
        child.pulse.enter("")  # that of the run before
        logs.present["stage"] = lambda: child.pulse.stage
        ending = self._watch(child, claim)
        log.info("run %d: %s%s", claim.run_id, ending.outcome, ending.text and f" ({ending.text})")
        self._settle(claim, ending)
        logs.present |= {"run": None, "stage": None}

    def _assist(self, child: Child) -> bool:
        """Simulate blocks of a run that another worker holds; false if there are none. The run never suffers from
        it."""
        resting = [run_id for run_id, rest in self._resting.items() if rest.until > time.monotonic()]
        claim = self.queue.shared(self.name, self.simulators, self.installation, resting)
        if claim is None:
            return False
        log.info("run %d: assisting", claim.run_id)
        began = time.monotonic()
        child.pulse.enter("")
        still, answer = Standstill(child.pulse, self._floor), None
        try:
            child.send({"assist": claim.as_json()})
            while answer is None and self._wakeup.signal is None and not self.drained and not still.look():
                answer = child.receive(WATCH)
                self._despite_outage(partial(self._beat_due, claim.run_id))
                published = self._files.look()
                if published is not None:  # what waits may need one of these
                    self.simulators = published["simulators"]
                    break
        except ChildEndedError as ended:
            answer, self.child = {"outcome": "died", "text": f"the worker process {ended}"}, None
        if answer is None or answer["outcome"] in ("failed", "spent", "edited"):
            self._drop_child()
        self._rest(claim.run_id, "" if answer is None else answer["outcome"], time.monotonic() - began)
        self._next_beat = 0.0
        log.info("run %d: assisted: %s", claim.run_id, answer or "stopped")
        return True

    def _rest(self, run_id: int, outcome: str, assisted: float) -> None:
        """Twice as long as before where that was longer than it assisted [s]; for good from a run of other code, until
        this worker's is replaced."""
        before = self._resting.get(run_id)
        pause = REST if before is None or assisted > before.pause else min(2 * before.pause, LONGEST_REST)
        if outcome in ("refused", "unusable"):
            pause = math.inf
        self._resting[run_id] = Rest(time.monotonic() + pause, pause)

    def _watch(self, child: Child, claim: Claim) -> Ending:
        """Send heartbeats while the child works; returns how the attempt ended."""
        try:
            child.send(claim.as_json())
            still = Standstill(child.pulse, self._floor)
            while True:
                answer = child.receive(WATCH)
                if answer is not None:
                    if answer["outcome"] in ("failed", "spent", "edited"):
                        self._drop_child()
                    return Ending(answer["outcome"], answer["text"])
                if self._wakeup.signal is not None:
                    self._drop_child()
                    return Ending("stopped")
                if self._cancel_requested(claim):
                    self._drop_child()
                    return Ending("cancelled")
                if self._outage:
                    still.excuse()
                if why := still.look():
                    self._drop_child()
                    return Ending("failed", f"the worker process {why}")
                published = self._files.look()
                if published is not None:
                    self.simulators = published["simulators"]
        except ChildEndedError as ended:
            self.child = None
            return Ending("killed" if ended.killed else "died", f"the worker process {ended}")
        except LostLease:
            return self._lost(child)

    def _cancel_requested(self, claim: Claim) -> bool:
        try:
            due = time.monotonic() >= self._next_beat
            if not due and not self.queue.cancel_requested(claim):
                return False
            self._next_beat = time.monotonic() + self.queue.lease / 5
            cancelling = self.queue.beat(claim)
            self._beat(claim.run_id)
            self._outage = False
            return cancelling
        except sa.exc.OperationalError as error:
            self._outage = True
            log.warning("run %d: heartbeat failed: %s", claim.run_id, worded(error))
            return False

    def _lost(self, child: Child) -> Ending:
        """Handle a lost lease: the run has ended, or another worker has it. A child that reports its end stays."""
        try:
            answer = child.receive(GRACE)
        except ChildEndedError:
            answer = None
        if answer is None:
            self._drop_child()
        return Ending(answer["outcome"] if answer and answer["outcome"] == "done" else "lost")

    def _settle(self, claim: Claim, ending: Ending) -> None:
        """Store how the attempt ended, in the queue."""
        queue = self.queue
        settle: dict[str, Callable[[], None]] = {
            "died": lambda: queue.retry(claim, ending.text),
            "killed": lambda: queue.lost(claim, ending.text),
            "failed": lambda: queue.retry(claim, ending.text),
            "edited": lambda: queue.retry(claim, ending.text),
            "refused": lambda: queue.refuse(claim, self.installation, ending.text),
            "unusable": lambda: queue.fail(claim, ending.text),
            "spent": lambda: queue.fail(claim, ending.text),
            "cancelled": lambda: queue.cancelled(claim),
            "stopped": lambda: queue.give_back(claim),
            "stale": lambda: queue.give_back(claim),
            "database": lambda: queue.put_off(claim, ending.text, PUT_OFF),
        }
        if ending.outcome not in settle:
            return
        patience = math.inf if ending.outcome == "database" else SETTLE
        for store in (settle[ending.outcome], lambda: queue.fail(claim, UNSTORED)):
            try:
                self._stored(claim, store, patience)
                return
            except Exception:  # it is the end of this run that cannot be stored: the worker continues with others
                log.exception("run %d: how its attempt ended could not be stored", claim.run_id)

    def _stored(self, claim: Claim, store: Callable[[], None], patience: float) -> None:
        """Store the end of an attempt, tried again for so long while the database cannot be used [s]."""
        begun = time.monotonic()
        while True:
            try:
                store()
                return
            except LostLease:
                log.info("run %d: was reassigned to another worker", claim.run_id)
                return
            except sa.exc.OperationalError as error:
                if time.monotonic() > begun + (patience if self._wakeup.signal is None else 1.0):
                    log.warning("run %d: left until its lease expires: %s", claim.run_id, worded(error))
                    return
                log.warning("run %d: its end could not be stored, trying again: %s", claim.run_id, worded(error))
            self._wakeup.wait(0.2)

    def _ready_child(self) -> Child | None:
        """The child, (re)started if there is none or the code has changed; None if it did not start (to be retried)."""
        child, files = self.child, self._files
        usable = child is not None and child.ready and child.alive() and not files.superseded
        if child and usable and (not files.due or self._is_fresh(child)):
            return child
        if child is None or child.ready or not child.alive():  # an outage may have interrupted the wait for its start
            self._drop_child()
            child = self.child = self._files.child()
        try:
            while self._wakeup.signal is None and time.monotonic() < child.begun + START:
                answer = child.receive(WATCH)
                if answer is not None:
                    self._failures, child.ready = 0, True
                    self.simulators, self.installation = answer["simulators"], answer["installation"]
                    self._next_beat = 0.0
                    return child if answer["fresh"] else None
                self._beat_due(None)
            how = f"did not start within {START:g} s"
        except ChildEndedError as ended:
            how = f"{ended} before it was ready"
        self._drop_child()
        if self._wakeup.signal is None:
            self._failures += 1
            if self._failures >= MOST_FAILURES:
                raise RuntimeError(f"the worker process {how}, {self._failures} times in a row")
            log.error("the worker process %s; starting it again", how)
            self._wakeup.wait(0.5 * 2**self._failures)
        return None

    def _is_fresh(self, child: Child) -> bool:
        """Whether the child's code still equals the files; the child checks this, since it recorded what it loaded."""
        began = time.monotonic()
        deadline = began + ANSWER
        try:
            child.send({"fresh": True})
            while self._wakeup.signal is None and time.monotonic() < deadline:
                answer = child.receive(WATCH)
                if answer is not None:
                    self._files.compared(began, answer["fresh"])
                    if not answer["fresh"]:
                        log.info("the code or a simulator has changed: restarting the worker process")
                    return bool(answer["fresh"])
        except ChildEndedError as ended:
            log.error("the worker process %s while it was idle; restarting it", ended)
        return self._wakeup.signal is not None

    def _drop_child(self) -> None:
        self._files.end()
        self._resting = {run_id: rest for run_id, rest in self._resting.items() if rest.pause < math.inf}
        if self.child is not None:
            self.child.kill()
            self.child = None

    def _beat_due(self, run_id: int | None) -> None:
        if time.monotonic() >= self._next_beat:
            self._next_beat = time.monotonic() + self.queue.lease / 5
            self._beat(run_id)

    def _beat(self, run_id: int | None) -> None:
        known = (run_id, self.simulators, self.installation, self._files.age, self._short)
        self.drained = write(self.engine, lambda connection: workers.beat(connection, self.name, *known), 0.0)
        self.queue.free()

    @property
    def _short(self) -> bool:
        return bool(self._room.short())

    def _notify(self, what: Callable[[sa.Connection, str], None]) -> None:
        write(self.engine, lambda connection: what(connection, self.name), 0.0)

    def _despite_outage(self, work: Callable[[], None]) -> None:
        try:
            work()
        except sa.exc.OperationalError as error:
            log.warning("%s", worded(error))
            if self.child is not None and not self.child.ready:
                self.child.begun = time.monotonic()  # it cannot publish, either
            self._wakeup.wait(1.0)
