"""After a reset, whatever follows a run shows what a new reader of it sees: nothing of what was discarded."""

from __future__ import annotations

from collections.abc import Callable

import httpx
import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import queue, waiting
from backend.db.engine import read
from backend.db.queue import Claim, Queue
from backend.db.store import RunStore
from backend.events.watch import Event, Watch
from backend.runs.service import number
from backend.scenes.base.progress import Progress
from backend.scenes.base.setting import load
from backend.scenes.panel.convergence_tab import columns
from campaigns.results.base import FAILED, OK
from campaigns.stored.records import Columns
from tests.given.finished_runs import PLAN, flight
from tests.given.service import Service
from tests.given.submissions import submit
from tests.results import nominal


def evaluated(first: int, costs: list[float]) -> Columns:
    count, values = len(costs), np.array(costs, dtype=np.float64).reshape(-1, 1)
    status = np.where(np.isnan(values[:, 0]), FAILED, OK).astype(np.uint8)
    reasons = {first + i: "diverged" for i in np.flatnonzero(status).tolist()}
    seconds = 0.1 * np.arange(first + 1, first + 1 + count, dtype=np.float64)
    return Columns(np.full((count, 2), 0.5), values, status, seconds, reasons)


def restarted(engine: sa.Engine, claim: Claim) -> bool:
    Queue(engine).refuse(claim, "another installation", "other code")
    with engine.begin() as writer:
        assert waiting.waits(writer, claim.run_id)
        waiting.restart(writer, claim.run_id)
    return True


def retried(engine: sa.Engine, claim: Claim) -> bool:
    Queue(engine).fail(claim, "no evaluation has a value")
    with engine.begin() as writer:
        return queue.resume(writer, claim.run_id)


def continued(engine: sa.Engine, claim: Claim) -> bool:
    Queue(engine).give_back(claim)
    return True


class Followers:
    """What follows a run for as long as somebody looks: the event streams, and a 3D view."""

    def __init__(self, engine: sa.Engine, run: int) -> None:
        self.engine, self.run, self.watch = engine, run, Watch(engine)
        with read(engine) as reader:
            self.progress = Progress(load(reader, run), run)

    def look(self) -> None:
        self.watch.look({self.run})
        with read(self.engine) as reader:
            self.progress.look(reader)

    def shown(self) -> tuple[list[Event], object, set[str], list[str]]:
        self.look()
        drawn = [column.tolist() for column in columns(list(self.progress.curves.values()))]
        return self.watch.everything(self.run), str(drawn), set(self.progress.flights), self.progress.choices


def work(engine: sa.Engine, claim: Claim | None) -> tuple[Claim, RunStore]:
    assert claim is not None
    store = RunStore(engine, claim)
    store.plan(PLAN)
    store.begin(2)
    return claim, store


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("before", "again"),
    [([0.9, 0.05, *[1.0] * 18], restarted), ([np.nan] * 20, retried), ([0.9, 0.05, *[1.0] * 18], continued)],
    ids=["restart", "retry without values", "resumed"],
)
def test_what_follows_a_run_shows_what_a_new_reader_sees(
    service: Service, client: httpx.Client, before: list[float], again: Callable[[sa.Engine, Claim], bool]
) -> None:
    run, engine = number(submit(client)), service.engine
    followers = Followers(engine, run)
    claim, store = work(engine, Queue(engine).claim("w1"))
    store.finish(0, nominal(), 0.01, traces=[flight("nominal")])
    store.append(2, 0, evaluated(0, before))
    followers.look()
    assert again(engine, claim)
    assert followers.shown() == Followers(engine, run).shown()
    _, store = work(engine, Queue(engine).claim("w1"))
    assert followers.shown() == Followers(engine, run).shown()
    first = len(before) if again is continued else 0
    for at, costs in ((first, [0.9, 0.5, 0.3, *[1.0] * 7]), (first + 10, [0.8] * 20), (first + 30, [0.7, 0.35])):
        store.append(2, at, evaluated(at, costs))
        assert followers.shown() == Followers(engine, run).shown()
