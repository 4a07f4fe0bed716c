"""What a single fault is, and how a run is hurt by it: it then has to end with every bit, by itself."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import sqlalchemy as sa

from backend.db.engine import read
from backend.db.tables import Stage
from tests.faults.processes import Started, until
from tests.storm.site import SAMPLE, SIMULATORS, Kind, Site
from worker.running.catalogue import installed

PATIENCE = 180.0
UNDER_WAY = 300.0
"""Until the moment of a fault, with the compilation of the loop [s]."""
BEGUN, MIDDLE = -1, -2
"""Moments: as soon as a worker has the run; after a third of the search."""
ATTEMPTS = 6
"""To hit a short stage while it runs."""


@dataclass(frozen=True)
class Row:
    """What a fault did: what was seen of it, evaluations lost and repeated, processes and folders left behind, and how
    long it took until the next result [s]; given_up: runs that did not end as done."""

    database: str
    name: str
    seen: str
    lost: int
    repeated: int
    left_behind: int
    given_up: int
    recovery_s: float


Hurt = Callable[[Site, Started], None]


@dataclass(frozen=True)
class Fault:
    """What is done, and when: at a number of stored evaluations, a moment, or while a stage of a kind runs.

    costs: evaluations that may fail, because the simulator itself was hurt; disk: the site is on a small disk.
    """

    what: Hurt
    at: int | str = MIDDLE
    of: Kind = "loop"
    costs: int = 0
    disk: bool = False

    @property
    def evaluations(self) -> int:
        """The moment as stored evaluations."""
        assert isinstance(self.at, int)
        return {MIDDLE: SAMPLE // 3 if self.of == "loop" else 260}.get(self.at, self.at)


def hurt(site: Site, database: str, name: str, fault: Fault) -> Row:
    """One run with one fault."""
    site.kind = fault.of
    run_id, worker = _struck(site, name, fault)
    stored, began = site.run(run_id).evaluations, time.monotonic()
    until(lambda: _restaffed(site, run_id) > stored or site.run(run_id).state == "done", f"{name}: goes on", PATIENCE)
    recovery = time.monotonic() - began
    seen = site.seen or site.run(run_id).error or last(worker)
    until(lambda: _restaffed(site, run_id) and site.ended(), f"{name}: ends", PATIENCE)
    return row(site, database, name, seen, recovery, fault.costs)


def row(site: Site, database: str, name: str, seen: str, recovery: float, costs: int = 0) -> Row:
    """What came of all runs of the site, whose workers are ended."""
    given_up = sum(state != "done" for state in site.states())
    lost, repeated = (
        sum(n) for n in zip(*(site.compared(number, seed, costs) for number, seed in site.runs.items()), strict=True)
    )
    site.stop()
    if costs:
        seen = "; ".join([f"{len(site.failed)} evaluations failed", *site.failed])[:110]
    left = site.left_behind()
    if left:
        seen = f"left behind: {', '.join(left)}"
    return Row(database, name, seen, lost, repeated, len(left), given_up, round(recovery, 1))


def last(worker: Started) -> str:
    """The end of the last line that it printed."""
    lines = worker.text().strip().splitlines() or [""]
    return lines[-1].split(" clearance", 1)[-1][-110:]


def _struck(site: Site, name: str, fault: Fault) -> tuple[int, Started]:
    """A run and its worker after the blow; a stage that had ended before it is tried again with another run."""
    worker = site.start()
    for _ in range(ATTEMPTS):
        if isinstance(fault.at, int):
            run_id = _beyond(site, name, fault.evaluations)
            if under_way := site.run(run_id).state != "done":
                fault.what(site, worker)
        else:
            run_id = _within(site, fault.at)
            fault.what(site, worker)
            under_way = _at(site, run_id, fault.at)
        if under_way:
            return run_id, worker
        site.staffed()
        worker = site.workers[-1]
        until(site.ended, f"{name}: ends", PATIENCE)
    raise AssertionError(f"{name}: its stage had ended before it in {ATTEMPTS} runs")


def _beyond(site: Site, name: str, evaluations: int) -> int:
    """A new run with more evaluations than this, or that has ended."""
    run_id = site.begin()

    def seen() -> bool:
        found = site.run(run_id)
        return bool(found.state == "done" or (found.state == "running" and found.evaluations > evaluations))

    until(seen, f"{name}: under way", UNDER_WAY)
    return run_id


def _within(site: Site, kind: str) -> int:
    """A new run in a stage of this kind, or after it."""
    run_id, until_then = site.begin(), time.monotonic() + UNDER_WAY
    while not _at(site, run_id, kind) and site.run(run_id).state != "done" and time.monotonic() < until_then:
        time.sleep(0.003)
    return run_id


def _at(site: Site, run_id: int, kind: str) -> bool:
    """Whether a stage of this kind runs; kind: its method, for one of several searches."""
    mine = sa.select(Stage.kind, Stage.method).where(Stage.run_id == run_id, Stage.state == "running")
    with read(site.engine) as connection:
        found = connection.execute(mine).first()
    return found is not None and kind in found


def _restaffed(site: Site, run_id: int) -> int:
    site.staffed()
    found: int = site.run(run_id).evaluations
    return found


@contextmanager
def kernels(folder: Path) -> Iterator[None]:
    """The workers compile into a folder of their own, which a fault may damage; the slow simulator is known here."""
    own = {"CLEARANCE_KERNEL_CACHE": str(folder), "CLEARANCE_SIMULATORS": str(SIMULATORS)}
    before = {name: os.environ.get(name) for name in own}
    os.environ |= own
    installed.forget_simulators()
    try:
        yield
    finally:
        installed.forget_simulators()
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value
