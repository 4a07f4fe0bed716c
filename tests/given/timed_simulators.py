"""A worker that has a simulator, and runs of it that measured its time."""

from __future__ import annotations

from typing import Any

from backend.db import queue, workers
from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns.asked.load import load_document
from campaigns.catalogue import Catalogue
from campaigns.results.measured import Measured
from campaigns.stored.records import StagePlan
from campaigns.versions import Code, Versions
from tests import results
from tests.given import finished_runs
from tests.given.service import Service
from tests.simulators import package, two_basins
from worker.running.catalogue.installed import catalogue

ENTRY = two_basins.ENTRY
METHODS = catalogue().methods


def publish(service: Service, digest: str | None = "aa", entry: Any = ENTRY) -> None:
    """A worker that has the simulator, with files of this digest."""
    digests = {} if digest is None else {ENTRY.name: digest}
    offered = Catalogue(version="1", components=[], methods=METHODS, simulators=[entry], digests=digests)
    with service.engine.begin() as connection:
        workers.publish(connection, offered)


def measured(**values: Any) -> Measured:
    """What a first stage reports of 15 evaluations."""
    known = {"points": 5, "evaluations": 15, "failed": 0, "identical": True, "spread": 0.0, "deviation": 0.0}
    return Measured.model_validate({**known, "seconds": 0.21, "call_seconds": 0.42, "slots": 2, **values})


def run(service: Service, digest: str, told: Measured | None, evaluations: int = 0) -> None:
    """A run whose first stage has ended, with so many evaluations stored."""
    with service.engine.begin() as connection:
        used = Catalogue(version="1", components=[], methods=[], simulators=[ENTRY])
        asked = load_document(package.campaign())
        queue.submit(connection, asked, name="a", tags=[], owner="ada", planned=1, catalogue=used)
    claim = Queue(service.engine).claim("w1", [ENTRY.version])
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan([StagePlan("nominal", None, 15)])
    store.record_versions(Versions(simulator=digest), Code("c", {}))
    store.begin(0)
    if evaluations:
        store.append(0, 0, finished_runs.search(0, evaluations))
    store.finish(0, results.nominal().model_copy(update={"measured": told}), 1.0)
    store.conclude(results.verdict("inconclusive", "Over.", 0.9, 0.3))
