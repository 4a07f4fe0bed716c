"""A run with evaluations that waits for the code that began it."""

from __future__ import annotations

import httpx

from backend.db import workers
from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns import Campaign
from campaigns.identity.code import model_of
from tests.given.code_versions import CODE, VERSIONS, parts
from tests.given.finished_runs import search
from tests.given.reported_runs import PLAN
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from tests.given.submissions import submit

HERE, OLD = "a" * 64, "b" * 64
DIFFERS = "the code digest was 0123456789ab, here it is ba9876543210"


def waiting(service: Service, client: httpx.Client, run: str = "") -> str:
    """A run with 100 evaluations that a worker of another version has refused; its worker is gone. run: one that is
    queued, otherwise a new one."""
    run = run or submit(client)
    claim = Queue(service.engine).claim("old", (), OLD)
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan(PLAN)
    model = model_of(Campaign.model_validate(campaign()), parts(CATALOGUE.model_dump(mode="json")))
    store.record_versions(VERSIONS.model_copy(update={"model": model}), CODE)
    store.begin(2)
    store.append(2, 0, search(0, 100))
    Queue(service.engine).give_back(claim)
    refusing = Queue(service.engine).claim("new", (), HERE)
    assert refusing is not None
    Queue(service.engine).refuse(refusing, HERE, DIFFERS)
    assert Queue(service.engine).claim("new", (), HERE) is None
    arrive(service, "new", HERE)
    return run


def arrive(service: Service, name: str, installation: str) -> None:
    with service.engine.begin() as connection:
        workers.arrive(connection, name)
        workers.beat(connection, name, None, (), installation)
