"""What runs on a node: a task evaluates a batch in a slot of the Dask worker, a process with all its protections.

A Dask worker has one slot for each of its threads that is busy. Slots start with the first task, stay warm between
tasks, and end with the run, with the worker, when idle, or when the process of the run no longer keeps them.

It imports nothing heavy: the scheduler loads it too.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import signal
import socket
import sys
import threading
import time
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

from worker.engine.systems.simulators.cluster.work import (
    ROOT,
    WORK,
    Done,
    NodeClosing,
    NodeUnusable,
    Work,
    check,
    forget,
    name,
)
from worker.engine.systems.simulators.slots.outcome import Outcome, Request
from worker.engine.systems.simulators.slots.places import Place
from worker.engine.systems.simulators.slots.pool import AHEAD, SHORT, SlotPool
from worker.engine.systems.simulators.slots.program import Program

ENOUGH = 0.4
"""A task begins no evaluation after this time [s]; it returns what has ended."""
IDLE = 60.0
"""Slots without work for this long are closed [s]."""
KEEP, LOST = 2.0, 15.0
"""How often a process keeps the slots of its pools, and after which time without it they are closed [s]: it was killed,
and nothing waits for what they evaluate."""


def evaluate(work: Work, requests: Sequence[Request]) -> Done:
    """Evaluate a batch one after another; it may return fewer outcomes than requests, at least one."""
    began = time.monotonic()
    check(work)
    slot = _take(work)
    try:
        outcomes = slot.evaluate(requests, began + ENOUGH)
    except BaseException:
        _drop(work.key, slot)
        raise
    with _lock:
        slot.busy = False
    return Done(outcomes, time.monotonic() - began)


def release(key: str) -> None:
    """Close the slots of a pool; what they evaluate has no result."""
    with _lock:
        found = _all_of(key)
        _released.append(key)
    _close(found)


def keep(keys: Sequence[str]) -> None:
    """The process of these pools is alive."""
    with _lock:
        _kept.update(dict.fromkeys(_kept.keys() & keys, time.monotonic()))


def saturation(dask_scheduler: Any) -> float:
    """How many tasks per thread the scheduler sends to a worker; runs there."""
    return float(dask_scheduler.WORKER_SATURATION)


def dask_setup(worker: object) -> None:
    """Dask calls it when a worker of `local:N` starts: Ctrl-C is for the process that closes the cluster."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)


class NodeSlot:
    """One process that evaluates, with a number that no other slot of this machine has, and a folder of its own."""

    def __init__(self, work: Work) -> None:
        self.closed, self._once = False, threading.Lock()
        self.busy = True
        """Whether a task has it; else it waits for the next one."""
        self.used = time.monotonic()
        self._mean = 1.0
        self._number, self._claim = _numbered()
        self._place = Place("node")
        self._pool = SlotPool(_here(work, str(self._place.path)).placed(self._number), 1, work.limits)

    def evaluate(self, requests: Sequence[Request], until: float) -> list[Outcome]:
        """Outcomes of the first requests; further ones begin until a moment of the monotonic clock."""
        running: deque[Future[Outcome]] = deque()
        found: list[Outcome] = []
        for request in requests:
            if time.monotonic() > until and (found or running):
                break
            running.append(self._submit(request))
            while len(running) >= (AHEAD if self._mean < SHORT else 1):
                found.append(self._ended(running.popleft()))
        found += [self._ended(future) for future in running]
        self.used = time.monotonic()
        return found

    def close(self) -> None:
        """Once, though its task and what ends it may both do so."""
        with self._once:
            if self.closed:
                return
            self.closed = True
        self._pool.close()
        self._claim.close()
        self._place.close()

    def _submit(self, request: Request) -> Future[Outcome]:
        try:
            return self._pool.submit(request)
        except RuntimeError as error:
            raise (NodeClosing if self.closed else NodeUnusable)(f"{name()}: {error}") from None

    def _ended(self, future: Future[Outcome]) -> Outcome:
        outcome = future.result()
        if self.closed:
            raise NodeClosing(name())
        self._mean += 0.1 * (outcome.duration - self._mean)
        return outcome


_lock = threading.Lock()
_slots: dict[str, list[NodeSlot]] = {}
"""By pool."""
_kept: dict[str, float] = {}
"""When a pool was last kept, or sent a task."""
_released: deque[str] = deque(maxlen=1000)
"""Their tasks may still arrive."""
_reaper: threading.Timer | None = None


def _take(work: Work) -> NodeSlot:
    with _lock:
        if work.key in _released:
            raise NodeClosing(name())
        _kept[work.key] = time.monotonic()
        for slot in _slots.get(work.key, []):
            if not slot.busy:
                slot.busy = True
                return slot
    try:
        made = NodeSlot(work)
    except OSError as error:
        raise NodeUnusable(f"{name()} cannot start a slot: {error}") from None
    with _lock:
        released = work.key in _released
        if not released:
            _slots.setdefault(work.key, []).append(made)
            _kept[work.key] = time.monotonic()
            _reap_later()
    if released:
        made.close()
        raise NodeClosing(name())
    return made


def _drop(key: str, slot: NodeSlot) -> None:
    with _lock:
        if slot in _slots.get(key, []):
            _slots[key].remove(slot)
    slot.close()


def _all_of(key: str) -> list[NodeSlot]:
    """The slots of a pool, which are no longer known here; the caller holds the lock."""
    forget(key)
    _kept.pop(key, None)
    return _slots.pop(key, [])


def _reap_later() -> None:
    """Start the timer that ends idle slots, if none is running; the caller holds the lock."""
    global _reaper
    if _reaper is None:
        _reaper = threading.Timer(LOST / 4, _reap)
        _reaper.daemon = True
        _reaper.start()


def _reap() -> None:
    """Close what was idle or not kept for long."""
    global _reaper
    at = time.monotonic()
    with _lock:
        lost = [slot for key, kept in list(_kept.items()) if kept < at - LOST for slot in _all_of(key)]
        old = [slot for slots in _slots.values() for slot in slots if not slot.busy and slot.used < at - IDLE]
        for key, slots in _slots.items():
            _slots[key] = [slot for slot in slots if slot not in old]
        _reaper = None
        if any(_slots.values()):
            _reap_later()
    _close(lost + old)


def _close(slots: Sequence[NodeSlot]) -> None:
    for slot in slots:
        with contextlib.suppress(OSError):  # the others are closed nevertheless
            slot.close()


@atexit.register
def _close_all() -> None:
    for key in list(_slots):
        release(key)


def _here(work: Work, folder: str) -> Program:
    """The program with this node's folder; one of ours with its interpreter and installation, too."""
    program = replace(work.program, folder=work.program.folder.replace(WORK, folder))
    if program.protocol != "framed":
        return program
    words = [w.replace(work.root, str(ROOT), 1) if w.startswith(work.root) else w for w in program.command[1:]]
    return replace(program, command=[sys.executable, *words])


def _numbered() -> tuple[int, socket.socket]:
    """The lowest number that no slot of this machine has, and what holds it until it is closed.

    Names of abstract sockets are those of the network namespace, as ports are, which numbers are often used for.
    """
    number = 0
    while True:
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            claim.bind(f"\0clearance-slot-{os.getuid()}-{number}")
            return number, claim
        except OSError:
            claim.close()
            number += 1
