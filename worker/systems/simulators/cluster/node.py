"""What runs on a node: a task evaluates a batch in a slot of the Dask worker, a process with all its protections.

A Dask worker has one slot for each of its threads that is busy. Slots start with the first task, stay warm between
tasks, and end with the run, with the worker, or when idle. Start reading at `evaluate`.

It imports nothing heavy: the scheduler loads it too.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from worker.catalogue.folder import digest_of
from worker.systems.simulators.slots.outcome import Limits, Outcome, Request
from worker.systems.simulators.slots.pool import AHEAD, SHORT, SlotPool
from worker.systems.simulators.slots.program import Program

WORK = "{work}"
"""Stands for the node's own temporary folder in the folder of a program."""
ROOT = Path(__file__).parents[4]
"""The folder of the installation."""
ENOUGH = 0.4
"""A task begins no evaluation after this time [s]; it returns what has ended."""
IDLE = 60.0
"""Slots without work for this long are closed [s]."""


class NodeUnusable(Exception):
    """A node would not compute what this process would; the message names it and the difference."""


class NodeClosing(Exception):
    """The node is shutting down, or the pool was closed: what it evaluated has no result."""


@dataclass(frozen=True)
class Work:
    """What a node needs to evaluate a simulator: the program, its limits, and what must be the same there.

    key: identifies the slots that belong together; python, root: interpreter and installation where the program was
    written down; folder, digest: the simulator's files; code: the digest of the code that runs slots.
    """

    key: str
    program: Program
    limits: Limits
    folder: str
    digest: str
    python: str = sys.executable
    root: str = str(ROOT)
    code: str = ""


@dataclass(frozen=True)
class Done:
    """The outcomes of the first evaluations of a batch, and how long the task took [s]."""

    outcomes: list[Outcome]
    seconds: float


def evaluate(work: Work, requests: Sequence[Request]) -> Done:
    """Evaluate a batch one after another; it may return fewer outcomes than requests, at least one."""
    began = time.monotonic()
    _check(work)
    slot = _take(work)
    try:
        outcomes = slot.evaluate(requests, began + ENOUGH)
    except BaseException:
        _drop(work.key, slot)
        raise
    _give_back(work.key, slot)
    return Done(outcomes, time.monotonic() - began)


def release(key: str) -> None:
    """Close the slots of a pool; what they evaluate has no result."""
    with _lock:
        found = _idle.pop(key, []) + _busy.pop(key, [])
        _checked.discard(key)
        _released.append(key)
    for slot in found:
        slot.close()


def saturation(dask_scheduler: Any) -> float:
    """How many tasks per thread the scheduler sends to a worker; runs there."""
    return float(dask_scheduler.WORKER_SATURATION)


def dask_setup(worker: object) -> None:
    """Dask calls it when a worker of `local:N` starts: Ctrl-C is for the process that closes the cluster."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)


@cache
def code() -> str:
    """The digest of the code that runs slots."""
    return digest_of(Path(__file__).parents[1])


class NodeSlot:
    """One process that evaluates, with a number that no other slot of this machine has, and a folder of its own."""

    def __init__(self, work: Work) -> None:
        self.closed = False
        self.used = time.monotonic()
        self._mean = 1.0
        self._number, self._claim = _numbered()
        self._folder = tempfile.mkdtemp(prefix="clearance-")
        self._pool = SlotPool(_here(work, self._folder).placed(self._number), 1, work.limits)

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
        self.closed = True
        self._pool.close()
        self._claim.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _submit(self, request: Request) -> Future[Outcome]:
        try:
            return self._pool.submit(request)
        except RuntimeError as error:
            raise (NodeClosing if self.closed else NodeUnusable)(f"{_name()}: {error}") from None

    def _ended(self, future: Future[Outcome]) -> Outcome:
        outcome = future.result()
        if self.closed:
            raise NodeClosing(_name())
        self._mean += 0.1 * (outcome.duration - self._mean)
        return outcome


_lock = threading.Lock()
_idle: dict[str, list[NodeSlot]] = {}
_busy: dict[str, list[NodeSlot]] = {}
_checked: set[str] = set()
_released: deque[str] = deque(maxlen=1000)
"""Their tasks may still arrive."""
_reaper: threading.Timer | None = None


def _take(work: Work) -> NodeSlot:
    with _lock:
        if work.key in _released:
            raise NodeClosing(_name())
        idle = _idle.get(work.key)
        slot = idle.pop() if idle else None
        if slot is not None:
            _busy.setdefault(work.key, []).append(slot)
            return slot
    try:
        made = NodeSlot(work)
    except OSError as error:
        raise NodeUnusable(f"{_name()} cannot start a slot: {error}") from None
    with _lock:
        released = work.key in _released
        if not released:
            _busy.setdefault(work.key, []).append(made)
            _reap_later()
    if released:
        made.close()
        raise NodeClosing(_name())
    return made


def _give_back(key: str, slot: NodeSlot) -> None:
    with _lock:
        if slot in _busy.get(key, []):
            _busy[key].remove(slot)
            _idle.setdefault(key, []).append(slot)


def _drop(key: str, slot: NodeSlot) -> None:
    with _lock:
        if slot in _busy.get(key, []):
            _busy[key].remove(slot)
    slot.close()


def _reap_later() -> None:
    """With the lock held."""
    global _reaper
    if _reaper is None:
        _reaper = threading.Timer(IDLE / 4, _reap)
        _reaper.daemon = True
        _reaper.start()


def _reap() -> None:
    """Close what was idle for long."""
    global _reaper
    oldest = time.monotonic() - IDLE
    with _lock:
        old = [slot for slots in _idle.values() for slot in slots if slot.used < oldest]
        for key in list(_idle):
            _idle[key] = [slot for slot in _idle[key] if slot not in old]
        _reaper = None
        if any(_idle.values()) or any(_busy.values()):
            _reap_later()
    for slot in old:
        slot.close()


@atexit.register
def _close_all() -> None:
    for key in [*_idle, *_busy]:
        release(key)


def _check(work: Work) -> None:
    """Compare code and files with those of the process that asks, once; raises `NodeUnusable`."""
    if work.code != code():
        raise NodeUnusable(
            f"{_name()} has another version of Clearance in {ROOT}: install the same one on all nodes, and restart "
            "their Dask workers"
        )
    if work.key not in _checked:
        different = _differs(work)
        if different:
            raise NodeUnusable(different)
        _checked.add(work.key)


def _differs(work: Work) -> str:
    folder = Path(work.folder)
    if not folder.is_dir():
        return f"{_name()} has no folder {folder}: put the simulator's folder under the same path on all nodes"
    try:
        digest = digest_of(folder)
    except OSError as error:
        return f"{_name()} cannot read the simulator's folder {folder}: {error.strerror}"
    if digest == work.digest:
        return ""
    return (
        f"{_name()} has other files in {folder} (digest {digest[:12]}, expected {work.digest[:12]}): "
        "copy the simulator's folder to all nodes"
    )


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


def _name() -> str:
    """The node in a sentence."""
    from distributed import get_worker

    address = ""
    with contextlib.suppress(ValueError):  # outside a task
        address = f" ({get_worker().address})"
    return f"node {socket.gethostname()}{address}"
