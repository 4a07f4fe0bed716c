"""Submitting, reading, listing and cancelling runs; everything refused leaves nothing behind."""

from __future__ import annotations

import json
import math
import time
import tracemalloc
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db.engine import now
from backend.db.queue import Queue
from backend.db.records import Conclusion, StagePlan
from backend.db.store import RunStore
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run
from campaigns import Campaign
from tests.api.catalogue import campaign
from tests.api.server import Service
from tests.api.test_access import problem
from tests.faults.cases import columns

YAML = {"content-type": "application/yaml"}


def submit(client: httpx.Client, **changes: Any) -> str:
    """Submit a campaign; returns the run's id."""
    answer = client.post("/api/v1/runs", json={"campaign": campaign(**changes)})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def altered(*path: str | int, value: Any) -> dict[str, Any]:
    """The campaign with the entry at that path replaced."""
    document: Any = json.loads(json.dumps(campaign()))
    place = document
    for step in path[:-1]:
        place = place[step] if isinstance(place, list) else place.setdefault(step, {})
    place[path[-1]] = value
    return dict(document)


def test_a_campaign_as_json_becomes_a_queued_run(service: Service, client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs", json={"campaign": campaign(), "name": "first", "tags": ["a", "b", "a"]})
    assert answer.status_code == 201
    run = answer.json()
    assert answer.headers["location"] == "/api/v1/runs/R-0001"
    assert (run["id"], run["name"], run["tags"], run["state"]) == ("R-0001", "first", ["a", "b"], "queued")
    assert (run["owner"], run["quantity"], run["unit"], run["threshold"]) == ("local", "d_min", "m", 0.5)
    assert run["planned"] == 1 + 21 * 2 + 1000 + 300
    assert run["campaign_digest"] == Campaign.model_validate(campaign()).digest
    detail = client.get("/api/v1/runs/R-0001").json()
    assert detail["campaign"] == Campaign.model_validate(campaign()).document()
    assert (detail["stages"], detail["rate"], detail["remaining"]) == ([], None, None)


def test_a_campaign_as_yaml_is_the_same_campaign(client: httpx.Client) -> None:
    answer = client.post("/api/v1/runs", content=yaml.safe_dump(campaign()), headers=YAML)
    assert answer.status_code == 201
    assert answer.json()["name"] == "Unicycle past a pillar"
    assert answer.json()["campaign_digest"] == Campaign.model_validate(campaign()).digest


def test_the_same_campaign_twice_is_stored_once(service: Service, client: httpx.Client) -> None:
    assert submit(client) != submit(client)
    rows = service.rows()
    assert (rows["runs"], rows["campaigns"]) == (2, 1)


WRONG: dict[str, tuple[dict[str, Any], str, str]] = {
    "unknown component": (
        altered("scenario", "vehicle", "component", value="unicylce"),
        "scenario.vehicle.component",
        "did you mean 'unicycle'?",
    ),
    "unknown key": (altered("scenario", "speeed", value=1), "scenario.speeed", "not known here"),
    "unknown parameter": (
        altered("scenario", "vehicle", "parameters", "mass", value=1.0),
        "scenario.vehicle.parameters.mass",
        "no such parameter",
    ),
    "value outside limits": (
        altered("scenario", "vehicle", "parameters", "m", value=-1.0),
        "scenario.vehicle.parameters.m",
        "lies within 0.001 to 100000 kg",
    ),
    "bound outside limits": (
        altered("uncertain", "vehicle.J", value={"low": -0.04, "high": 0.06}),
        "uncertain.vehicle.J.low",
        "lies within",
    ),
    "reversed interval": (
        altered("uncertain", "vehicle.J", value={"low": 0.06, "high": 0.04}),
        "uncertain.vehicle.J",
        "reversed",
    ),
    "wrong unit": (
        altered("uncertain", "vehicle.m", value={"plus_minus": "20%", "unit": "g"}),
        "uncertain.vehicle.m.unit",
        "is kg",
    ),
    "unknown method": (altered("stages", "search", 0, "method", value="magic"), "stages.search.0.method", "no such"),
    "absurd size": (altered("scenario", "step", value=1e-9), "scenario", "steps"),
    "missing scenario": ({"name": "x"}, "scenario", "required"),
}


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


UNREADABLE = {
    "yaml syntax": ("name: [unclosed\n  x: 1", "application/yaml", "YAML"),
    "yaml alias": ("name: &a x\nsummary: *a", "application/yaml", "aliases"),
    "yaml key twice": ("name: x\nname: y", "application/yaml", "given twice"),
    "yaml object": ("name: !!python/object/apply:os.system [id]", "application/yaml", "YAML"),
    "yaml list": ("- 1", "application/yaml", "mapping"),
    "yaml deep": ("[" * 20000, "application/yaml", "YAML"),
    "empty yaml": ("", "application/yaml", "mapping"),
    "json syntax": ('{"campaign": ', "application/json", "JSON"),
    "json key twice": ('{"campaign": {}, "campaign": {}}', "application/json", "given twice"),
    "json deep": ("[" * 100_000, "application/json", "JSON"),
    "json list": ("[1]", "application/json", ""),
    "json nothing": ("{}", "application/json", "required"),
    "json nan": (json.dumps({"campaign": campaign(criterion={"threshold": math.nan})}), "application/json", "finite"),
    "unknown key": (json.dumps({"campaign": campaign(), "extra": 1}), "application/json", "Extra"),
    "bad tag": (json.dumps({"campaign": campaign(), "tags": ["a b"]}), "application/json", "pattern"),
    "no text": (b"\xff\xfe\x00", "application/json", "UTF-8"),
}  # fmt: skip


@pytest.mark.parametrize("case", UNREADABLE)
def test_an_unreadable_body_is_refused_and_stores_nothing(still: Service, guest: httpx.Client, case: str) -> None:
    content, kind, message = UNREADABLE[case]
    before = still.rows()
    answer = guest.post("/api/v1/runs", content=content, headers={"content-type": kind})
    assert message in str(problem(answer, 422)["errors"])
    assert still.rows() == before
    assert guest.get("/api/v1/health").json() == {"status": "ok"}


def test_malformed_yaml_is_told_by_line(guest: httpx.Client) -> None:
    answer = guest.post("/api/v1/runs", content="name: x\nscenario: {a: 1, a: 2}\n", headers=YAML)
    errors = problem(answer, 422)["errors"]
    assert isinstance(errors, list)
    assert errors[0]["field"].startswith("line 2")


def test_another_media_type_is_refused(still: Service, guest: httpx.Client) -> None:
    problem(guest.post("/api/v1/runs", content="x", headers={"content-type": "text/csv"}), 415)
    problem(guest.post("/api/v1/runs", content="x"), 415)
    assert still.rows()["runs"] == 0


def test_before_a_worker_came_a_submit_answers_503(bare: Service) -> None:
    before = bare.rows()["runs"]
    with bare.visitor(authorization=f"Bearer {bare.token()}") as program:
        answer = program.post("/api/v1/runs", json={"campaign": campaign()})
        assert "clearance worker" in str(problem(answer, 503)["detail"])
        assert int(answer.headers["retry-after"]) > 0
        problem(program.get("/api/v1/components"), 503)
    assert bare.rows()["runs"] == before


def chunks(count: int, size: int = 1_000_000) -> Iterator[bytes]:
    for _ in range(count):
        yield b" " * size


def test_a_body_of_50_mb_is_refused_unread(still: Service, guest: httpx.Client) -> None:
    before = still.rows()
    tracemalloc.start()
    try:
        announced = guest.post("/api/v1/runs", content=b" " * 50_000_000, headers=YAML)
        tracemalloc.reset_peak()
        start = tracemalloc.get_traced_memory()[0]
        unannounced = guest.post("/api/v1/runs", content=chunks(50), headers=YAML)
        peak = tracemalloc.get_traced_memory()[1] - start
    finally:
        tracemalloc.stop()
    assert "at most 2,000,000 bytes" in str(problem(announced, 413)["detail"])
    assert "at most 2,000,000 bytes" in str(problem(unannounced, 413)["detail"])
    assert peak < 20_000_000
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
    store.finish(0, {"cost": 0.94}, 0.1)
    parts = {"scope": "these bounds", "quantity": "d_min", "unit": "m"}
    store.conclude(Conclusion("cleared", "Cleared, within bounds.", 0.94, 0.9417402345678901, "direct", parts))
    detail = client.get(f"/api/v1/runs/{run}").json()
    assert (detail["verdict"], detail["reason"], detail["summary"]) == ("cleared", "Cleared, within bounds.", parts)
    assert detail["worst_cost"] == 0.9417402345678901
    assert detail["margin"] == 0.9417402345678901 - 0.5


def fill(service: Service, count: int) -> None:
    """Many runs in every state, written straight into the table."""
    asked = Campaign.model_validate(campaign())
    with service.engine.begin() as connection:
        at = now(connection)
        row = {"digest": asked.digest, "name": asked.name, "document": asked.document(), "created": at}
        connection.execute(sa.insert(CampaignRow).values(**row))
        states = ("done", "failed", "cancelled", "done", "queued")
        verdicts = ("cleared", None, None, "violated", None)
        rows = [
            {
                "campaign_digest": asked.digest,
                "name": f"run {i % 7}",
                "tags": ["even" if i % 2 == 0 else "odd", "50%_"],
                "owner": "ada" if i % 3 else "bob",
                "state": states[i % 5],
                "verdict": verdicts[i % 5],
                "created": at + i,
                "started": at + i if states[i % 5] != "queued" else None,
                "threshold": 0.5,
                "worst_cost": None if verdicts[i % 5] is None else 0.1 * (i % 11) + 0.1 + 0.2,
            }
            for i in range(count)
        ]
        connection.execute(sa.insert(Run), rows)


def walk(client: httpx.Client, **query: Any) -> list[dict[str, Any]]:
    """Every page of a list, one after the other."""
    found: list[dict[str, Any]] = []
    cursor: dict[str, str] = {}
    while True:
        page = client.get("/api/v1/runs", params={**query, **cursor}).json()
        found += page["items"]
        if page["next_cursor"] is None:
            return found
        cursor = {"cursor": page["next_cursor"]}


SORTS = ("created", "started", "finished", "name", "state", "verdict", "margin", "worst", "evaluations")


@pytest.mark.parametrize("sort", [*SORTS, *(f"-{s}" for s in SORTS)])
def test_pages_together_are_the_whole_list_in_order(service: Service, client: httpx.Client, sort: str) -> None:
    fill(service, 60)
    runs = walk(client, sort=sort, limit=7)
    assert sorted(r["id"] for r in runs) == [f"R-{i:04d}" for i in range(1, 61)]
    key = {"worst": "worst_cost", "created": "created"}.get(sort.lstrip("-"), sort.lstrip("-"))
    values = [r[key] for r in runs]
    told = [v for v in values if v is not None]
    assert told == sorted(told, reverse=sort.startswith("-"))
    assert values == told + [None] * (len(values) - len(told))


def test_a_page_holds_its_place_while_runs_come_in(service: Service, client: httpx.Client) -> None:
    fill(service, 10)
    first = client.get("/api/v1/runs", params={"limit": 5}).json()
    submit(client, seed=7)
    second = client.get("/api/v1/runs", params={"limit": 5, "cursor": first["next_cursor"]}).json()
    assert [r["id"] for r in first["items"] + second["items"]] == [f"R-{i:04d}" for i in range(10, 0, -1)]


def test_filters_and_counts(service: Service, client: httpx.Client) -> None:
    fill(service, 50)
    page = client.get("/api/v1/runs", params={"state": "done", "verdict": "violated", "tag": "odd"}).json()
    assert len(page["items"]) == 5
    assert {r["verdict"] for r in page["items"]} == {"violated"}
    assert (page["counts"]["total"], page["counts"]["violated"], page["counts"]["cleared"]) == (25, 5, 5)
    several = client.get("/api/v1/runs", params={"state": ["queued", "failed"]}).json()["items"]
    assert {r["state"] for r in several} == {"queued", "failed"}


@pytest.mark.parametrize(
    ("q", "count"),
    [
        ("run R-0007", 1),
        ("R-0007", 1),
        ("BOB", 17),
        ("even ada", 16),
        ("pillar", 50),
        ("50%_", 50),
        ("5%_%", 0),
        ("zzz", 0),
    ],
)
def test_search_words_are_all_to_be_found(service: Service, client: httpx.Client, q: str, count: int) -> None:
    fill(service, 50)
    page = client.get("/api/v1/runs", params={"q": q, "limit": 200}).json()
    assert len(page["items"]) == count
    assert page["counts"]["total"] == count


@pytest.mark.parametrize("cursor", ["x", "eA", "W10", "WyJuYW1lIiwgMSwgMV0", "é", "A" * 900])
def test_a_bad_cursor_is_refused(guest: httpx.Client, cursor: str) -> None:
    document = problem(guest.get("/api/v1/runs", params={"cursor": cursor}), 422)
    assert "cursor" in str(document["detail"])


def test_a_cursor_of_another_order_is_refused(service: Service, client: httpx.Client) -> None:
    fill(service, 5)
    cursor = client.get("/api/v1/runs", params={"limit": 2}).json()["next_cursor"]
    problem(client.get("/api/v1/runs", params={"sort": "name", "cursor": cursor}), 422)


@pytest.mark.parametrize(
    "query", [{"limit": 0}, {"limit": 1000}, {"sort": "colour"}, {"state": "odd"}, {"q": "x" * 999}]
)
def test_a_bad_query_is_refused(guest: httpx.Client, query: dict[str, Any]) -> None:
    errors = problem(guest.get("/api/v1/runs", params=query), 422)["errors"]
    assert isinstance(errors, list)
    assert errors[0]["field"].startswith(next(iter(query)))


def test_the_list_stays_fast_with_ten_thousand_runs(service: Service, client: httpx.Client) -> None:
    fill(service, 10_000)
    for query in (
        {},
        {"sort": "-margin"},
        {"q": "run 3"},
        {"tag": "odd", "state": "done"},
        {"sort": "name", "limit": 200},
    ):
        used = []
        for _ in range(3):
            begun = time.process_time()
            page = client.get("/api/v1/runs", params=query).json()
            used.append(time.process_time() - begun)
        assert page["next_cursor"]
        assert min(used) < 0.2, query


def test_a_campaign_of_another_version_is_said_to_be_one(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    with service.engine.begin() as connection:
        connection.execute(sa.update(CampaignRow).values(document={"version": 2}))
    assert client.get("/api/v1/runs").status_code == 200
    problem(client.get(f"/api/v1/runs/{run}/evaluations"), 409)


def test_a_fault_of_ours_is_a_problem_that_tells_nothing(service: Service, client: httpx.Client) -> None:
    with service.engine.begin() as connection:
        connection.execute(sa.text("update catalogue set document = '{}'"))
    answer = client.get("/api/v1/components")
    assert "log" in str(problem(answer, 500)["detail"])
    assert "pydantic" not in answer.text
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert client.get("/api/v1/health").status_code == 200
