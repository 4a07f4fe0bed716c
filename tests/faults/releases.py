"""Checkouts of this repository that differ in one file, and runs that this one has begun. Read `Release`, `begin`."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import sqlalchemy as sa

from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from campaigns import Campaign
from campaigns.stages.plan import plan
from campaigns.stored.records import Columns, StagePlan
from tests import results
from tests.faults.processes import REPOSITORY, Started, started
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.running.opening import opened
from worker.running.runs import provenance


class Release:
    """Another version of the product: a copy of it with edits; without any it is this one, where it is.

    Copies into one folder after another find what was compiled there, which is known by file and time.
    """

    def __init__(self, folder: Path, *edits: tuple[str, str, str]) -> None:
        self.folder = folder if edits else REPOSITORY
        for room in ("backend", "campaigns", "clearance", "worker") if edits else ():
            shutil.rmtree(folder / room, ignore_errors=True)
            shutil.copytree(REPOSITORY / room, folder / room)
        for file, old, new in edits:
            text = (folder / file).read_text(encoding="utf-8")
            assert old in text, f"{file} has no {old!r}"
            (folder / file).write_text(text.replace(old, new, 1), encoding="utf-8")

    @contextmanager
    def worker(self, url: str, output: Path, name: str, *options: str) -> Iterator[Started]:
        """A worker of this version; the folder of this process is not on its path. output: the folder of its log."""
        command = [sys.executable, "-P", "-m", "clearance", "worker", "--name", name, *options]
        paths = {"PYTHONPATH": f"{self.folder}:{REPOSITORY}", "CLEARANCE_DATABASE": url, "CLEARANCE_THREADS": "1"}
        with started(command, output, name, **paths) as running:
            yield running


def begin(engine: sa.Engine, campaign: Campaign, many: int = 1) -> list[int]:
    """Runs whose nominal stage this process has completed, with the code that it has loaded; back in the queue."""
    with engine.begin() as connection:
        for _ in range(many):
            submit(connection, campaign, name=campaign.name, tags=[], owner="", planned=0)
    queue = Queue(engine)
    claims = [claim for _ in range(many) if (claim := queue.claim("begun"))]
    for claim in claims:
        store, problem = RunStore(engine, claim), Problem(campaign, opened.closed_loop(campaign))
        records = store.plan([StagePlan(*planned) for planned in plan(campaign)])
        provenance.begin(store, problem.system, campaign, records)
        store.begin(0)
        batch, _ = problem.evaluate(problem.nominal_point[None, :])
        store.append(0, 0, evaluated(problem, batch))
        store.finish(0, results.nominal(float(batch.costs[0, 0])), 0.01)
        queue.give_back(claim)
    return [claim.run_id for claim in claims]


def evaluated(problem: Problem, batch: Batch) -> Columns:
    """The nominal evaluation, as the stage stores it."""
    return Columns(problem.nominal_point[None, :], batch.costs, batch.status, np.array([0.01]), {})
