"""A run that waits for the code that began it: what the service says, and the two ways on that it offers."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db import refusals
from backend.db.engine import read
from backend.db.queue import Queue
from backend.db.queue import submit as put
from backend.db.refusals import AGAIN
from backend.db.roles import LOCAL
from backend.db.store import RunStore
from backend.db.sweeps import in_sweep
from backend.db.tables import CatalogueDocument, EvaluationChunk, Run, RunRefusal, Sweep, SweepRun, Worker
from backend.db.waiting import CONTINUED
from backend.runs.onward import PUT_BACK
from backend.runs.quota import Quota
from backend.runs.waiting import PUT_BACK as PUT_BACK_FILE
from backend.runs.waiting import SAME_MACHINE, SOON
from backend.signoffs.present import present
from campaigns.runs import run_name
from campaigns.versions import NOT_INSTALLED, OTHER_POINTS
from tests.given.code_versions import CODE, VERSIONS, edited
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from tests.given.submissions import YAML, submit
from tests.given.waiting_runs import DIFFERS, HERE, OLD, arrive, waiting
from tests.simulators import noisy
from tests.simulators.adversaries import adversary, never
from worker.engine.systems.base import CampaignUnusable
from worker.running.runs.runner import execute


def one(client: httpx.Client, run: str) -> dict[str, Any]:
    return dict(client.get(f"/api/v1/runs/{run}").json())


def stored(service: Service) -> tuple[int, int]:
    """The chunks of evaluations, and the refusals."""
    with read(service.engine) as reader:
        found = [reader.scalar(sa.select(sa.func.count()).select_from(t)) for t in (EvaluationChunk, RunRefusal)]
    return found[0] or 0, found[1] or 0


def drain(service: Service, name: str) -> None:
    with service.engine.begin() as writer:
        writer.execute(sa.update(Worker).where(Worker.name == name).values(draining=True))


def test_it_says_what_differs_until_a_worker_of_its_version_is_there(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    found = one(client, run)
    assert (found["state"], found["other_code"], found["evaluations"]) == ("queued", DIFFERS, 100)
    assert found["waits"] == (
        f"Other code began it than the running workers have: {DIFFERS}. A worker of the version that began it "
        "continues it, if it still runs or the database was not updated since; or begin it again, without its 100 "
        "evaluations; or continue it as a new run, with those that are still valid, if any."
    )
    arrive(service, "old", OLD)
    found = one(client, run)
    assert found["other_code"] is None
    assert found["waits"] == SOON
    for way in ("restart", "continuation"):
        refused = client.post(f"/api/v1/runs/{run}/{way}")
        assert (refused.status_code, refused.json()["type"]) == (409, "urn:clearance:problem:not-waiting")
    assert stored(service) == (1, 1)
    drain(service, "old")
    assert one(client, run)["other_code"] == DIFFERS
    assert client.post(f"/api/v1/runs/{run}/restart").status_code == 200


def test_a_run_whose_component_is_missing_waits_for_it_and_is_not_offered_to_be_begun_again(
    service: Service, client: httpx.Client
) -> None:
    run, differs = waiting(service, client), f"a component, method or stage of it {NOT_INSTALLED}"
    with service.engine.begin() as writer:
        refusals.store(writer, 1, HERE, differs)
    waits = one(client, run)["waits"]
    assert f": {differs}. {PUT_BACK_FILE}, " in waits
    assert "begin it again" not in waits


def test_a_run_that_another_kind_of_machine_began_waits_for_one(service: Service, client: httpx.Client) -> None:
    run, differs = waiting(service, client), f"{OTHER_POINTS}: the processor was znver9, here it is znver4"
    with service.engine.begin() as writer:
        refusals.store(writer, 1, HERE, differs)
    found = one(client, run)
    assert found["other_code"] == differs
    assert f": {differs}. {SAME_MACHINE}; " in found["waits"]


def test_a_worker_looks_again_at_a_run_that_it_refused_long_ago(service: Service, client: httpx.Client) -> None:
    waiting(service, client)
    queue = Queue(service.engine)
    assert queue.claim("new", (), HERE) is None
    with service.engine.begin() as writer:
        writer.execute(sa.update(RunRefusal).values(created=RunRefusal.created - AGAIN - 1.0))
    claim = queue.claim("new", (), HERE)
    assert claim is not None
    queue.refuse(claim, HERE, DIFFERS)
    assert queue.claim("new", (), HERE) is None


def test_what_was_submitted_for_another_version_waits_for_it(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    claim = Queue(service.engine).claim("new", (), HERE)
    assert claim is not None
    Queue(service.engine).refuse(claim, HERE, DIFFERS)
    arrive(service, "new", HERE)
    found = one(client, run)
    assert (found["state"], found["other_code"]) == ("queued", None)
    assert DIFFERS in found["waits"]
    arrive(service, "newest", OLD)
    assert one(client, run)["waits"] == SOON
    drain(service, "newest")
    assert client.post(f"/api/v1/runs/{run}/restart").status_code == 200
    assert Queue(service.engine).claim("new", (), HERE) is not None, "it is tried again"


def test_begun_again_it_has_nothing_of_before(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    assert stored(service) == (1, 1)
    answer = client.post(f"/api/v1/runs/{run}/restart")
    assert answer.status_code == 200, answer.text
    assert stored(service) == (0, 0)
    fresh = one(client, submit(client))
    again = one(client, run)
    own = {"id", "created", "waits", "planned"}
    assert {k: v for k, v in again.items() if k not in own} == {k: v for k, v in fresh.items() if k not in own}
    assert client.get(f"/api/v1/runs/{run}/history").json()[0]["action"] == "run.restarted"
    assert client.post(f"/api/v1/runs/{run}/restart").status_code == 409
    assert Queue(service.engine).claim("new", (), HERE) is not None


def test_continued_as_a_new_run(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    assert one(client, run)["not_continuable"] is None
    answer = client.post(f"/api/v1/runs/{run}/continuation")
    assert answer.status_code == 201, answer.text
    made = answer.json()
    assert answer.headers["Location"].endswith(f"/api/v1/runs/{made['id']}")
    assert (made["continues"], made["state"], made["other_code"]) == (run, "queued", None)
    old = one(client, run)
    assert (old["state"], old["error"], old["evaluations"]) == ("cancelled", CONTINUED.format(run=made["id"]), 100)
    claim = Queue(service.engine).claim("new", (), HERE)
    assert claim is not None
    cited = RunStore(service.engine, claim).cited()
    assert cited is not None
    assert (cited.begun.versions.code, {at: len(c.status) for at, c in cited.evaluations.items()}) == (
        CODE.digest, {2: 100},
    )  # fmt: skip
    repeated = client.post(f"/api/v1/runs/{run}/continuation")
    assert (repeated.status_code, repeated.json()["type"]) == (409, "urn:clearance:problem:not-waiting")


def test_what_is_continued_keeps_its_text_its_group_and_its_place_in_a_sweep(
    service: Service, client: httpx.Client
) -> None:
    text = "# kept\n" + yaml.safe_dump(campaign())
    queued = client.post("/api/v1/runs", params={"group": "main"}, content=text, headers=YAML).json()["id"]
    run = waiting(service, client, queued)
    with service.engine.begin() as writer:
        named = dict.fromkeys(("name", "campaign_name", "path", "title", "unit", "owner"), "")
        writer.execute(sa.insert(Sweep).values(id=1, created=0.0, **named))
        writer.execute(sa.insert(SweepRun).values(sweep_id=1, position=0, value=1.0, run_id=int(run[2:])))
    made = client.post(f"/api/v1/runs/{run}/continuation").json()["id"]
    assert one(client, made)["group"] == "main"
    assert client.get(f"/api/v1/runs/{made}/campaign.yaml").text.partition("\n")[2].startswith("# kept\n")
    assert [member["run"] for member in client.get("/api/v1/sweeps/S-0001").json()["points"]] == [made]
    with read(service.engine) as reader:
        assert present(reader, [campaign()["name"]]).newest == {}, "neither is a run of the campaign itself"
    newer = client.post("/api/v1/runs", params={"group": "main"}, json={"campaign": campaign()}).json()
    assert newer["superseded"] == [made]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("swept", [1, 2, 3, 4])
def test_every_run_of_a_chain_is_a_variant_if_one_is(service: Service, client: httpx.Client, swept: int) -> None:
    """Runs that gave their place in a sweep to the one that continues them, and those that extend a variant."""
    ids = [int(submit(client)[2:]) for _ in range(5)]
    with service.engine.begin() as writer:
        for run_id in ids[1:4]:
            writer.execute(sa.update(Run).where(Run.id == run_id).values(continues=run_id - 1))
        named = dict.fromkeys(("name", "campaign_name", "path", "title", "unit", "owner"), "")
        writer.execute(sa.insert(Sweep).values(id=1, created=0.0, **named))
        writer.execute(sa.insert(SweepRun).values(sweep_id=1, position=0, value=1.0, run_id=swept))
        assert set(writer.scalars(sa.select(Run.id).where(in_sweep()))) == {1, 2, 3, 4}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("way", ["retry", "restart", "continuation"])
def test_a_request_that_is_repeated_with_its_key_is_answered_with_the_run(
    service: Service, client: httpx.Client, way: str
) -> None:
    run = waiting(service, client)
    if way == "retry":
        claim = Queue(service.engine).claim("old", (), OLD)
        assert claim is not None
        Queue(service.engine).fail(claim, "The disk is full.")
    first, again = (
        client.post(f"/api/v1/runs/{run}/{way}", headers={"Idempotency-Key": "k1"}).raise_for_status() for _ in range(2)
    )
    assert first.json()["id"] == again.json()["id"]
    entries = client.get(f"/api/v1/runs/{first.json()['id']}/history").json()
    assert [entry["action"] for entry in entries].count(entries[0]["action"]) == 1


def test_who_is_beyond_the_quota_continues_nothing(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    service.app.state.quota = Quota(100, 100, 10**12)
    refused = client.post(f"/api/v1/runs/{run}/continuation")
    assert (refused.status_code, refused.json()["type"]) == (409, "urn:clearance:problem:quota-reached")
    service.app.state.quota = Quota(1, 101, 10**12)  # the run that ends makes room for its continuation
    assert client.post(f"/api/v1/runs/{run}/continuation").status_code == 201


def test_evaluations_of_another_model_are_not_continued(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=edited()))
    answer = client.post(f"/api/v1/runs/{run}/continuation")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-continuable")
    assert one(client, run)["not_continuable"] == answer.json()["detail"]
    assert one(client, run)["state"] == "queued"


def test_a_campaign_that_cannot_be_run_here_is_not_continued(service: Service, client: httpx.Client) -> None:
    """The stored campaign is no error of the request: its method is no longer installed."""
    run = waiting(service, client)
    fewer = CATALOGUE.model_dump(mode="json")
    fewer["methods"] = [method for method in fewer["methods"] if method["name"] != "direct"]
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=fewer))
    answer = client.post(f"/api/v1/runs/{run}/continuation")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-continuable")
    assert "stages.search.0.method" in answer.json()["detail"]
    assert one(client, run)["not_continuable"] == answer.json()["detail"]


@pytest.mark.parametrize("gone", ["unicycle", "circle", "separation", "direct"])
def test_what_cannot_be_run_here_is_not_begun_again(service: Service, client: httpx.Client, gone: str) -> None:
    """Without its evaluations it would fail for good."""
    run = waiting(service, client)
    fewer = CATALOGUE.model_dump(mode="json")
    for kind in ("components", "methods"):
        fewer[kind] = [entry for entry in fewer[kind] if entry["name"] != gone]
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=fewer))
    before = one(client, run)
    answer = client.post(f"/api/v1/runs/{run}/restart")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-continuable")
    assert gone in answer.json()["detail"]
    assert answer.json()["detail"].endswith(PUT_BACK)
    assert one(client, run) == before
    assert stored(service) == (1, 1)
    with service.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=CATALOGUE.model_dump(mode="json")))
    assert client.post(f"/api/v1/runs/{run}/restart").status_code == 200


def test_evaluations_of_an_unknown_model_are_not_continued(service: Service, client: httpx.Client) -> None:
    """As of a run that a version began which did not store it: a new run would begin without any of them."""
    run = waiting(service, client)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(flown=VERSIONS.model_dump(mode="json")))
    answer = client.post(f"/api/v1/runs/{run}/continuation")
    assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-continuable")
    assert one(client, run)["not_continuable"] == answer.json()["detail"]
    assert one(client, run)["state"] == "queued"


def test_a_run_that_does_not_wait_for_its_code(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    for way in ("restart", "continuation"):
        answer = client.post(f"/api/v1/runs/{run}/{way}")
        assert (answer.status_code, answer.json()["type"]) == (409, "urn:clearance:problem:not-waiting")
        assert client.post(f"/api/v1/runs/R-9999/{way}").status_code == 404


def test_a_failed_run_is_retried(service: Service, client: httpx.Client) -> None:
    run = waiting(service, client)
    refused = client.post(f"/api/v1/runs/{run}/retry")
    assert (refused.status_code, refused.json()["type"]) == (409, "urn:clearance:problem:not-failed")
    queue = Queue(service.engine)
    claim = queue.claim("old", (), OLD)
    assert claim is not None
    queue.fail(claim, "The disk is full.")
    assert one(client, run)["state"] == "failed"
    found = client.post(f"/api/v1/runs/{run}/retry").json()
    assert (found["state"], found["error"], found["evaluations"], found["finished"]) == ("queued", None, 100, None)
    entry = client.get(f"/api/v1/runs/{run}/history").json()[0]
    assert (entry["action"], entry["detail"]) == ("run.retried", {"evaluations": 100, "error": "The disk is full."})
    assert queue.claim("old", (), OLD) is not None
    assert client.post("/api/v1/runs/R-9999/retry").status_code == 404


def test_a_run_of_a_simulator_that_was_repaired_reaches_its_verdict(service: Service, client: httpx.Client) -> None:
    """None of its evaluations had a value, so that they are made again."""
    queue, asked = Queue(service.engine), noisy.campaign()
    with service.engine.begin() as writer:
        number = put(writer, asked, name="a run", tags=[], owner=LOCAL, planned=1)
    claim = queue.claim("w")
    assert claim is not None
    with adversary(lost=never), pytest.raises(CampaignUnusable) as failure:
        execute(asked, RunStore(service.engine, claim), threads=1)
    queue.fail(claim, f"{failure.value}")
    run = run_name(number)
    failed = one(client, run)
    assert failed["evaluations"] == failed["failed_evaluations"] > 0
    found = client.post(f"/api/v1/runs/{run}/retry").raise_for_status().json()
    assert (found["state"], found["error"], found["evaluations"], found["started"]) == ("queued", None, 0, None)
    entry = client.get(f"/api/v1/runs/{run}/history").json()[0]
    assert entry["action"] == "run.retried"
    assert entry["detail"] == {"evaluations": 0, "error": failed["error"], "discarded": failed["evaluations"]}
    claim = queue.claim("w")
    assert claim is not None
    with adversary():
        execute(asked, RunStore(service.engine, claim), threads=1)
    found = one(client, run)
    assert (found["state"], found["verdict"], found["failed_evaluations"]) == ("done", "cleared", 0)


def test_a_removed_run_is_not_retried(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    queue = Queue(service.engine)
    claim = queue.claim("w")
    assert claim is not None
    queue.fail(claim, "The disk is full.")
    assert client.delete(f"/api/v1/runs/{run}", params={"reason": "x"}).is_success
    refused = client.post(f"/api/v1/runs/{run}/retry")
    assert (refused.status_code, refused.json()["type"]) == (409, "urn:clearance:problem:removed")
