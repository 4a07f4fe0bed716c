"""A run whose simulator's declaration is edited: what the service says, and the ways on that it offers."""

from __future__ import annotations

import httpx
import pytest
import sqlalchemy as sa

from backend.db import queue, workers
from backend.db.engine import read
from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import Run
from backend.runs.waiting import SOON
from campaigns import check
from campaigns.asked.load import load_document
from campaigns.catalogue import Catalogue, SimulatorEntry
from campaigns.runs import run_name
from campaigns.stored.records import StagePlan
from campaigns.versions import Code, Versions
from tests.given.at_night import nightly_but
from tests.given.edited_declarations import EDITS, ENTRY, WORDS
from tests.given.service import Service
from tests.simulators import package
from worker.running.catalogue.installed import catalogue

CAMPAIGN = load_document(package.campaign())
CHANGED = f"simulators/{ENTRY.name} has changed"


def offered(entry: SimulatorEntry) -> Catalogue:
    return Catalogue(version="1", components=[], methods=catalogue().methods, simulators=[entry])


def submitted(service: Service, begun: bool) -> int:
    """A run of which a worker that is gone has begun the first stage, or none has."""
    with service.engine.begin() as connection:
        known = offered(ENTRY)
        run_id = queue.submit(connection, CAMPAIGN, name="a", tags=[], owner="local", planned=1, catalogue=known)
    if begun:
        claim = Queue(service.engine).claim("gone", [ENTRY.version], "old")
        assert claim is not None
        store = RunStore(service.engine, claim)
        store.plan([StagePlan("nominal", None, 15)])
        store.record_versions(Versions(simulator="aa"), Code("c", {}))
        Queue(service.engine).give_back(claim)
    return run_id


def arrive(service: Service, entry: SimulatorEntry) -> None:
    with service.engine.begin() as connection:
        workers.publish(connection, offered(entry))
        workers.arrive(connection, "new")
        workers.beat(connection, "new", None, entry.versions, "new")


BEGUN = [(field, begun) for field in EDITS for begun in (True, False)]
FIELDS = ("text", "step", "parameters.low", "parameters.default", "parameters, one less", "results.name")
"""Of words and of all else, with which a campaign fits and does not."""
BY_DAY = [(field, begun) for field, begun in BEGUN if field in FIELDS and (begun or "." not in field)]


@pytest.mark.by_day(3)
@pytest.mark.parametrize("edit", nightly_but(BY_DAY, BEGUN), ids=lambda v: f"{v[0]}, {'' if v[1] else 'not '}begun")
def test_every_edit_leaves_a_true_sentence_and_a_way_on(
    service: Service, client: httpx.Client, edit: tuple[str, bool]
) -> None:
    field, begun = edit
    run_id, edited = submitted(service, begun), EDITS[field]
    run = f"/api/v1/runs/{run_name(run_id)}"
    arrive(service, edited)
    work = Queue(service.engine)
    claim, found = work.claim("new", edited.versions, "new"), client.get(run).json()
    if field in WORDS:
        assert claim is not None
        work.refuse(claim, "new", CHANGED)  # as one that was begun with other files
        found = client.get(run).json()
    else:
        assert claim is None
    assert found["state"] == "queued"
    assert CHANGED in found["waits"]
    assert found["other_code"] == (CHANGED if begun or field not in WORDS else None)
    answer = client.post(f"{run}/restart")
    if check(CAMPAIGN, offered(edited)):
        assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-continuable")
        assert work.claim("new", edited.versions, "new") is None
    else:
        assert answer.status_code == 200, answer.text
        assert work.claim("new", edited.versions, "new") is not None


def test_some_edits_leave_a_campaign_that_can_be_run_and_some_do_not() -> None:
    fits = {field for field, edited in EDITS.items() if not check(CAMPAIGN, offered(edited))}
    assert WORDS < fits < set(EDITS)


def test_a_run_that_an_earlier_version_submitted_is_taken(service: Service, client: httpx.Client) -> None:
    run_id = submitted(service, True)
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(needs=ENTRY.versions[1]))
    arrive(service, ENTRY)
    assert client.get(f"/api/v1/runs/{run_name(run_id)}").json()["waits"] == SOON
    assert Queue(service.engine).claim("new", ENTRY.versions, "new") is not None


def test_one_that_is_begun_again_needs_the_simulator_as_it_is_now(service: Service, client: httpx.Client) -> None:
    run_id, edited = submitted(service, True), EDITS["parameters.default"]
    arrive(service, edited)
    assert client.post(f"/api/v1/runs/{run_name(run_id)}/restart").status_code == 200
    with read(service.engine) as reader:
        assert reader.scalar(sa.select(Run.needs).where(Run.id == run_id)) == edited.version
    arrive(service, ENTRY)
    assert Queue(service.engine).claim("new", ENTRY.versions, "new") is None


def test_it_is_listed_with_a_simulator_once(service: Service, client: httpx.Client) -> None:
    arrive(service, ENTRY)
    (worker,) = client.get("/api/v1/workers").json()["items"]
    assert worker["simulators"] == [ENTRY.name]
