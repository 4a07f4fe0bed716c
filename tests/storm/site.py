"""A database with runs and workers that are hurt, and what is compared with a run that nobody has disturbed."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import sqlalchemy as sa

from backend.db.engine import connect, migrate, read
from backend.db.queue import Claim, submit
from backend.db.store import RunStore
from backend.db.tables import Run, Stage
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results.base import FAILED, TIMEOUT
from campaigns.sample_seed import SampleSeed
from campaigns.stages.plan import most
from tests.faults.long import case
from tests.faults.machines import Machine
from tests.faults.processes import Started, alive, command_of, kill, until, worker
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

MARK = "CLEARANCE_STORM"
SEED = SampleSeed(20_261_125, stated=True)
SAMPLE = 12_000
OPTIONS = ("--lease", "2", "--standstill", "5")


SIMULATORS = Path(__file__).parent / "simulators"
SLOW = {
    "name": "slow",
    "simulator": {"name": "slow"},
    "uncertain": {f"simulator.{name}": {"low": 0.0, "high": 1.0} for name in "ab"},
    "criterion": {"result": "d", "threshold": 0.5},
    "stages": {
        "sensitivity": {"points": 25},
        "search": [{"method": "direct", "evaluations": 60}, {"method": "monte_carlo", "evaluations": 300}],
        "certify": {"samples": 80},
        "validate": {"neighbours": 20, "evaluations": 200},
    },
    "baseline": {
        "run": "R-0001",
        "digest": "0" * 64,
        "threshold": 0.5,
        "cases": [
            {"label": f"F{k}", "parameters": {"simulator.a": k / 50, "simulator.b": 0.2}, "cost": 0.3}
            for k in range(1, 41)
        ],
    },
}
Kind = Literal["loop", "slots"]
"""What is simulated: a closed loop in the child itself, or a program in its slots."""


@cache
def campaign(seed: int = 1, kind: Kind = "loop") -> Campaign:
    """Case 1 with a search that is long enough to be hurt in its middle; or the slow program in slots."""
    if kind == "slots":
        return load_document({**SLOW, "seed": seed})
    document = case().document()
    document["stages"]["search"][1]["evaluations"] = SAMPLE
    return Campaign.model_validate({**document, "seed": seed})


@cache
def undisturbed(seed: int, kind: Kind = "loop") -> MemoryStore:
    """The same run in this process."""
    store = MemoryStore(sample_seed=SEED)
    execute(campaign(seed, kind), store)
    return store


class Site:
    """One database, its workers, and the folder for their temporary files."""

    def __init__(self, url: str, folder: Path, stack: ExitStack) -> None:
        self.url, self.folder, self.stack = url, folder, stack
        self.kind: Kind = "loop"
        self.settings: dict[str, str] = {}
        """Of workers that are started from now on."""
        self.temporary = folder / "temporary"
        self.temporary.mkdir(parents=True)
        self.mark = f"{os.getpid()}-{folder.name}"
        self.engine = connect(url)
        self.workers: list[Started] = []
        self.runs: dict[int, int] = {}
        """The seed of each that was queued here."""
        self.seen = ""
        """What a fault states of itself."""
        self.failed: list[str] = []
        """Why evaluations failed that have a value in an undisturbed run."""

    def begin(self, seed: int = 1) -> int:
        """Queue a run."""
        asked = campaign(seed, self.kind)
        with self.engine.begin() as connection:
            run_id = submit(connection, asked, name="storm", tags=[], owner="", planned=most(asked), seed=SEED)
        self.runs[run_id] = seed
        return run_id

    def run(self, run_id: int) -> Any:
        with read(self.engine) as connection:
            return connection.execute(sa.select(Run).where(Run.id == run_id)).one()

    def states(self) -> list[str]:
        """Of all runs, also those that others have posted."""
        with read(self.engine) as connection:
            return list(connection.scalars(sa.select(Run.state)))

    def ended(self) -> bool:
        return {*self.states()} <= {"done", "failed"}

    @property
    def environment(self) -> dict[str, str]:
        """Of all that is started here."""
        return {MARK: self.mark, "TMPDIR": str(self.temporary), "CLEARANCE_SIMULATORS": str(SIMULATORS)}

    def start(self, machine: Machine | None = None) -> Started:
        """One more worker; on a machine of its own, it has a data folder of its own."""
        name, url, within, environment = f"w{len(self.workers) + 1}", self.url, [], self.environment
        if machine is not None:
            environment["CLEARANCE_DATA"] = environment["HOME"] = str(self.folder / machine.space)
            Path(environment["HOME"]).mkdir(exist_ok=True)
            url, within = machine.url, machine.within
        entered = worker(url, self.folder, name, *OPTIONS, within=within, **environment, **self.settings)
        self.workers.append(self.stack.enter_context(entered))
        return self.workers[-1]

    def staffed(self, number: int = 1) -> None:
        """Have as many workers as before, as a service manager would."""
        while sum(one.process.poll() is None for one in self.workers) < number:
            self.start()

    def stop(self) -> None:
        """End all workers in order."""
        for one in self.workers:
            if one.process.poll() is None:
                kill(one.pid, number=signal.SIGTERM)
        until(lambda: all(one.process.poll() is not None for one in self.workers), "all workers have ended", 60)

    def left_behind(self) -> list[str]:
        """Processes and folders that are still there some seconds after the workers have ended."""
        until_then = time.monotonic() + 6.0
        while self._left() and time.monotonic() < until_then:
            time.sleep(0.05)
        return self._left()

    def _left(self) -> list[str]:
        processes = [f"{pid} {command_of(pid)}" for pid in self._marked()]
        return processes + [str(path.relative_to(self.temporary)) for path in self.temporary.rglob("*")]

    def _marked(self) -> Iterator[int]:
        sought = f"{MARK}={self.mark}".encode()
        for entry in filter(str.isdigit, os.listdir("/proc")):
            try:
                environment = Path("/proc", entry, "environ").read_bytes()
            except OSError:
                continue
            if sought in environment.split(b"\0") and alive(int(entry)):
                yield int(entry)

    def compared(self, run_id: int, seed: int = 1, costs: int = 0) -> tuple[int, int]:
        """Evaluations that are missing, and those that are there twice or have other bits than an undisturbed run.

        costs: so many may have failed, as those of a simulator that was hurt.
        """
        store = RunStore(self.engine, Claim(run_id, 0, 0, 0, "", {}))
        expected = undisturbed(seed, self.kind)
        lost = repeated = 0
        with read(self.engine) as connection:
            stages = connection.execute(sa.select(Stage).where(Stage.run_id == run_id).order_by(Stage.position)).all()
        for stage in stages:
            found, right = store.evaluations(stage.position), expected.evaluations(stage.position)
            here, there = (0 if one is None else len(one.status) for one in (found, right))
            lost += max(0, there - here)
            repeated += max(0, here - there)
            if found is not None and right is not None and here == there:
                same = (found.points == right.points).all(axis=1) & _equal(found.costs, right.costs).all(axis=1)
                failed = ~same & np.isin(found.status, (FAILED, TIMEOUT))
                self.failed += [found.reasons.get(int(k), "") for k in np.flatnonzero(failed)]
                costs -= int(failed.sum())
                repeated += int((~same & ~failed).sum())
        return lost, repeated + max(0, -costs)


def _equal(a: Any, b: Any) -> Any:
    return (a == b) | (np.isnan(a) & np.isnan(b))


@contextmanager
def site(url: str, folder: Path) -> Iterator[Site]:
    """A site on a migrated database; all its processes are killed at the end."""
    migrate(url)
    with ExitStack() as stack:
        made = Site(url, folder, stack)
        try:
            yield made
        finally:
            made.engine.dispose()
