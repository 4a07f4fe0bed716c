"""Submitting, reading and cancelling runs; refused requests change nothing."""

from __future__ import annotations

import json

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import CampaignRow, Run
from backend.runs.texts import with_schema
from campaigns import Campaign
from campaigns.asked.load import load_text
from campaigns.stages.attraction import AttractionResult
from campaigns.stages.plan import most
from campaigns.stored.records import StagePlan
from tests import results
from tests.faults.cases import columns
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import WRONG, YAML, submit


def test_a_campaign_as_json_becomes_a_queued_run(service: Service, client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs", json={"campaign": campaign(), "name": "first", "tags": ["a", "b", "a"]})
    assert answer.status_code == 201
    run = answer.json()
    assert answer.headers["location"] == "/api/v1/runs/R-0001"
    assert (run["id"], run["name"], run["tags"], run["state"]) == ("R-0001", "first", ["a", "b"], "queued")
    assert (run["owner"], run["quantity"], run["unit"], run["threshold"]) == ("local", "d_min", "m", 0.5)
    assert run["planned"] == most(Campaign.model_validate(campaign()))
    assert run["campaign_digest"] == Campaign.model_validate(campaign()).digest
    detail = client.get("/api/v1/runs/R-0001").json()
    assert detail["campaign"] == Campaign.model_validate(campaign()).document()
    assert (detail["stages"], detail["rate"], detail["remaining"]) == ([], None, None)


def test_a_campaign_as_yaml_is_the_same_campaign(client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs", content=yaml.safe_dump(campaign()), headers=YAML)
    assert answer.status_code == 201
    assert answer.json()["name"] == campaign()["name"]
    assert answer.json()["campaign_digest"] == Campaign.model_validate(campaign()).digest


def test_a_run_stores_the_original_text_of_its_campaign(service: Service, client: httpx.Client) -> None:
    document = campaign()
    text = "# Ours.\n" + yaml.safe_dump(document) + "# The end.\n"
    assert client.post("/api/v1/runs", content=text, headers=YAML).status_code == 201
    together = {"campaign": document, "name": "Another", "text": text.replace("The end", "No end")}
    assert client.post("/api/v1/runs", json=together).status_code == 201
    third = submit(client)
    files = [client.get(f"/api/v1/runs/{run}/campaign.yaml") for run in ("R-0001", "R-0002", third)]
    assert [file.headers["content-type"].partition(";")[0] for file in files] == ["application/yaml"] * 3
    modeline = f"# yaml-language-server: $schema={service.url}/api/v1/campaigns/schema\n"
    assert [file.text for file in files[:2]] == [modeline + text, modeline + together["text"]]
    assert load_text(files[2].text).digest == Campaign.model_validate(document).digest
    other = client.post("/api/v1/runs", json=together | {"text": text.replace("threshold: 0.5", "threshold: 0.6")})
    found = problem(other, 422)
    assert [error["field"] for error in found["errors"]] == ["text"]
    assert "a different campaign" in found["errors"][0]["message"]
    problem(client.post("/api/v1/runs", json=together | {"text": "name: ["}), 422)
    problem(client.get("/api/v1/runs/R-0004/campaign.yaml"), 404)
    with service.engine.begin() as writer:
        writer.execute(sa.update(CampaignRow).values(document=document | {"version": 0}))
    assert yaml.safe_load(client.get(f"/api/v1/runs/{third}/campaign.yaml").text)["version"] == 0


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("name: x\n", "{}name: x\n"),
        ("\ufeffname: x\n", "{}name: x\n"),
        ("# yaml-language-server: $schema=http://old/api/v1/campaigns/schema\r\nname: x\n", "{}name: x\n"),
        (
            "# yaml-language-server: $schema=ours.json\nname: x\n",
            "# yaml-language-server: $schema=ours.json\nname: x\n",
        ),
        ('\n{"name": "x"}', '\n{"name": "x"}'),
        ("", "{}"),
    ],
)
def test_yaml_names_its_schema_once(text: str, shown: str) -> None:
    found = with_schema(text, "http://new")
    modeline = "# yaml-language-server: $schema=http://new/api/v1/campaigns/schema\n"
    assert found == (shown if "ours" in shown or '"' in shown else shown.format(modeline))
    assert with_schema(found, "http://new") == found


def test_a_run_names_the_one_it_extends(service: Service, client: httpx.Client) -> None:
    first, second = submit(client), submit(client, seed=2)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 2).values(continues=1))
    assert client.get(f"/api/v1/runs/{second}").json()["continues"] == first
    assert [r["continues"] for r in client.get("/api/v1/runs").json()["items"]] == [first, None]


def test_the_same_campaign_twice_is_stored_once(service: Service, client: httpx.Client) -> None:
    assert submit(client) != submit(client)
    rows = service.rows()
    assert (rows["runs"], rows["campaigns"]) == (2, 1)


@pytest.mark.parametrize("case", WRONG)
@pytest.mark.parametrize("form", ["json", "yaml"])
def test_a_wrong_campaign_is_refused_field_by_field_and_stores_nothing(
    still: Service, guest: httpx.Client, case: str, form: str
) -> None:
    document, field, message = WRONG[case]
    before = still.rows()
    if form == "json":
        answer = guest.post("/api/v1/runs", json={"campaign": document})
    else:
        answer = guest.post("/api/v1/runs", content=yaml.safe_dump(document), headers=YAML)
    errors = problem(answer, 422)["errors"]
    assert isinstance(errors, list)
    assert any(e["field"] == field and message in e["message"] for e in errors), errors
    assert still.rows() == before
    assert guest.get("/api/v1/health").json() == {"status": "ok"}


def test_the_same_key_gives_the_same_run(service: Service, client: httpx.Client) -> None:
    body, key = json.dumps({"campaign": campaign()}), {"idempotency-key": "k-1", "content-type": "application/json"}
    first = client.post("/api/v1/runs", content=body, headers=key)
    again = client.post("/api/v1/runs", content=body, headers=key)
    assert (first.status_code, again.status_code) == (201, 201)
    assert first.json() == again.json()
    assert service.rows()["runs"] == 1


def test_the_same_key_for_another_body_is_refused(service: Service, client: httpx.Client) -> None:
    key = {"idempotency-key": "k-1"}
    client.post("/api/v1/runs", json={"campaign": campaign()}, headers=key)
    before = service.rows()
    answer = client.post("/api/v1/runs", json={"campaign": campaign(seed=2)}, headers=key)
    assert "R-0001" in str(problem(answer, 422)["detail"])
    assert service.rows() == before


def test_a_key_belongs_to_its_user(service: Service, client: httpx.Client) -> None:
    key = {"idempotency-key": "k-1"}
    mine = client.post("/api/v1/runs", json={"campaign": campaign()}, headers=key).json()["id"]
    with service.visitor(authorization=f"Bearer {service.token()}") as program:
        theirs = program.post("/api/v1/runs", json={"campaign": campaign()}, headers=key).json()["id"]
    assert mine != theirs


def test_a_key_that_is_too_long_is_refused(guest: httpx.Client) -> None:
    answer = guest.post("/api/v1/runs", json={"campaign": campaign()}, headers={"idempotency-key": "k" * 129})
    problem(answer, 422)


@pytest.mark.parametrize("run", ["R-9999", "R-0", "1", "R-", "r-0001", "R-99999999999999999999", "x"])
@pytest.mark.parametrize("rest", ["", "/stages", "/evaluations", "/findings", "/traces", "/traces/nominal"])
def test_an_unknown_run_is_not_found(guest: httpx.Client, run: str, rest: str) -> None:
    problem(guest.get(f"/api/v1/runs/{run}{rest}"), 404)


def test_unknown_addresses_and_methods_are_problems_too(guest: httpx.Client) -> None:
    problem(guest.get("/api/v1/nothing"), 404)
    problem(guest.delete("/api/v1/runs"), 405)
    problem(guest.post("/api/v1/runs/R-0009/cancel"), 404)


def test_a_queued_run_is_cancelled_at_once(client: httpx.Client) -> None:
    run = submit(client)
    assert client.post(f"/api/v1/runs/{run}/cancel").json()["state"] == "cancelled"
    assert client.post(f"/api/v1/runs/{run}/cancel").json()["state"] == "cancelled"


def test_the_time_left_names_the_stages_that_it_leaves_out(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stage that computes without evaluations has no speed, and lends none to others."""
    monkeypatch.setattr("backend.runs.service.computing", lambda campaign: ["attraction"])
    run, claim = submit(client), Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    plans = [StagePlan(kind, None, planned) for kind, planned in (("nominal", 1), ("search", 20), ("attraction", 0))]
    store.plan([*plans, StagePlan("validate", None, 50)])
    for position in (0, 1):
        store.begin(position)
        store.append(position, 0, columns(0, plans[position].planned))
        store.finish(position, [results.nominal(), results.searched()][position], 0.2)
    store.begin(2)
    shown = client.get(f"/api/v1/runs/{run}").json()
    assert (shown["rate"], shown["remaining"], shown["untimed"]) == (None, pytest.approx(50 / 100.0), ["Attraction"])
    store.finish(2, AttractionResult(states=[], held=[], flow=[]), 40.0)
    store.begin(3)
    shown = client.get(f"/api/v1/runs/{run}").json()
    assert (shown["rate"], shown["remaining"], shown["untimed"]) == (pytest.approx(100.0), pytest.approx(0.5), [])


def test_a_running_run_shows_its_stage_pace_and_cancelling(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", 100)])
    store.begin(1)
    store.append(1, 0, columns(0, 20))
    detail = client.get(f"/api/v1/runs/{run}").json()
    assert (detail["state"], detail["worker"], detail["stage"]["method"]) == ("running", "w1", "direct")
    assert detail["evaluations"] == 20
    assert detail["rate"] == pytest.approx(100.0)
    assert detail["remaining"] == pytest.approx((1 + 80) / 100.0)
    assert [s["state"] for s in client.get(f"/api/v1/runs/{run}/stages").json()] == ["waiting", "running"]
    assert client.post(f"/api/v1/runs/{run}/cancel").json()["state"] == "cancelling"


def test_a_finished_run_shows_its_verdict(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan([StagePlan("nominal", None, 1)])
    store.finish(0, results.nominal(0.94), 0.1)
    verdict = results.verdict("cleared", "Cleared, within bounds.", 0.94, 0.9417402345678901)
    store.conclude(verdict)
    detail = client.get(f"/api/v1/runs/{run}").json()
    assert (detail["verdict"], detail["reason"]) == ("cleared", "Cleared, within bounds.")
    assert len(detail["summary"]["provenance"].pop("evidence")) == 64
    assert detail["summary"] == verdict.model_dump(mode="json")
    assert detail["worst_cost"] == 0.9417402345678901
    assert detail["margin"] == 0.9417402345678901 - 0.5


def test_a_campaign_of_another_version_is_reported_as_such(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    with service.engine.begin() as connection:
        connection.execute(sa.update(CampaignRow).values(document={"version": 2}))
    assert client.get("/api/v1/runs").status_code == 200
    problem(client.get(f"/api/v1/runs/{run}/evaluations"), 409)


def test_an_internal_error_is_a_problem_without_internal_details(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    with service.engine.begin() as connection:
        connection.execute(sa.text("update runs set tags = '{}'"))
    answer = client.get(f"/api/v1/runs/{run}")
    assert "log" in str(problem(answer, 500)["detail"])
    assert "pydantic" not in answer.text
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert client.get("/api/v1/health").status_code == 200
