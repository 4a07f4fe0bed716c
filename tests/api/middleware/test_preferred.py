"""Answers in the form that a client prefers: every time as RFC 3339, every list in one envelope, else as ever."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from datetime import datetime
from typing import Any

import httpx
import pytest
from starlette.datastructures import Headers

from backend.http.schema import UNIX_TIME, Instant, Schema
from backend.middleware.preferences import LISTS, TIMES, preferences, rfc3339, with_times
from clearance import Client
from tests.given.finished_runs import finish
from tests.given.openapi_document import DOCUMENT
from tests.given.service import Service
from tests.given.submissions import submit

BOTH = {"Prefer": f"{TIMES}, {LISTS}"}


class Renamed(Schema):
    """A field of any name is a time by its type."""

    whenever: Instant
    perhaps: Instant | None
    several: list[Instant]
    since: float


def numbers() -> Iterator[tuple[str, str, bool, str]]:
    """Model, field, whether it is marked as a time, and description of every number in an answer."""
    for model, schema in DOCUMENT["components"]["schemas"].items():
        for field, described in schema.get("properties", {}).items():
            for option in (described, *described.get("anyOf", ())):
                if option.get("type") == "number":
                    yield model, field, option.get("format") == UNIX_TIME, described.get("description", "")


def test_every_number_that_is_described_as_a_time_is_marked() -> None:
    statement = {(model, field) for model, field, _, text in numbers() if "since 1970" in text}
    marked = {(model, field) for model, field, is_marked, _ in numbers() if is_marked}
    assert statement
    assert statement <= marked
    assert {("RunSummary", "created"), ("Workers", "now"), ("StageProgress", "finished")} <= marked
    assert marked.isdisjoint({("RunSummary", "margin"), ("StageProgress", "seconds"), ("RunDetail", "remaining")})


def test_a_time_of_any_name_is_rewritten_and_a_number_of_any_name_is_not() -> None:
    values = {"whenever": 0.0, "perhaps": None, "several": [1.5], "since": 5.0}
    found = with_times(values, Renamed.model_json_schema(), {})
    texts = {"whenever": "1970-01-01T00:00:00.000000Z", "several": ["1970-01-01T00:00:01.500000Z"]}
    assert found == values | texts


def test_answers_have_the_preferred_form(service: Service, client: httpx.Client) -> None:
    submit(client)
    finish(service)
    usual, found = (client.get("/api/v1/runs/R-0001", headers=headers) for headers in ({}, BOTH))
    assert (usual.headers.get("preference-applied"), found.headers["preference-applied"]) == (None, f"{LISTS}, {TIMES}")
    assert "Prefer" in found.headers["vary"]
    for name in ("created", "started"):
        assert isinstance(usual.json()[name], float)
        text = found.json()[name]
        assert text.endswith("Z")
        assert datetime.fromisoformat(text).timestamp() == pytest.approx(usual.json()[name], abs=1e-5)
    assert found.json()["stages"][0]["started"].startswith("20")
    same = {"campaign", "evaluations", "campaign_digest", "best_so_far", "threshold"}
    assert {name: usual.json()[name] for name in same} == {name: found.json()[name] for name in same}
    page = client.get("/api/v1/runs", headers=BOTH).json()
    assert page["items"][0]["created"].endswith("Z")
    for address in ("/findings", "/traces", "/stages", "/history", "/exports"):
        plain = client.get(f"/api/v1/runs/R-0001{address}").json()
        listed = client.get(f"/api/v1/runs/R-0001{address}", headers={"Prefer": LISTS}).json()
        assert listed == {"items": plain, "next_cursor": None}, address
    assert client.post("/api/v1/runs/cancel", json={"runs": ["R-0001"]}, headers=BOTH).json()["next_cursor"] is None
    refused = client.get("/api/v1/runs/R-0042", headers=BOTH)
    assert (refused.status_code, refused.headers["content-type"]) == (404, "application/problem+json")


def test_files_and_streams_stay_as_they_are(service: Service, client: httpx.Client) -> None:
    submit(client)
    finish(service)
    for address in ("exports/run.json", "exports/evaluations.csv", "campaign.yaml"):
        plain, found = (client.get(f"/api/v1/runs/R-0001/{address}", headers=headers) for headers in ({}, BOTH))
        assert plain.content == found.content, address
        assert "preference-applied" not in found.headers
    head = client.head("/api/v1/runs/R-0001", headers=BOTH)
    assert (head.status_code, head.content) == (200, b"")


def test_the_python_client_reads_either(service: Service, client: httpx.Client) -> None:
    submit(client)
    with (
        Client(service.url, service.token()) as one,
        Client(service.url, service.token("b"), headers={"Prefer": TIMES}) as other,
    ):
        assert abs((one.run("R-0001").created - other.run("R-0001").created).total_seconds()) < 1e-4


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("times=rfc3339", {TIMES}),
        ('Times = "RFC3339"; x=1, respond-async', {TIMES}),
        ("lists=envelope,times=rfc3339", {TIMES, LISTS}),
        ("times=unix", set()),
        ("", set()),
        (",;=," * 2000, set()),
    ],
)
def test_preferences_of_any_text(header: str, found: set[str]) -> None:
    assert preferences(Headers({"Prefer": header})) == found


@pytest.mark.parametrize("value", [None, True, "x", -1.0, 1e12, float("nan"), 10**400])
def test_what_is_no_time_stays(value: Any) -> None:
    assert rfc3339(value) is value


def test_fields_of_the_same_name_in_a_campaign_stay() -> None:
    schema = {"properties": {"parameters": {"type": "object", "additionalProperties": {"type": "number"}}}}
    assert with_times({"parameters": {"since": 5.0}}, schema, {}) == {"parameters": {"since": 5.0}}


@pytest.mark.parametrize(("path", "headers"), [("/api/v1/runs", BOTH), ("/api/v1/openapi.json", {})])
def test_the_document_is_not_made_on_the_event_loop(
    service: Service, client: httpx.Client, path: str, headers: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    first: list[int | None] = []
    real = service.app.openapi

    def noted() -> dict[str, object]:
        first.append(threading.get_ident())
        return real()

    monkeypatch.setattr(service.app, "openapi", noted)
    assert client.get(path, headers=headers).status_code == 200
    assert first[0] != service._thread.ident
