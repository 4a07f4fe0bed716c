"""GET /batch: what each path would answer alone, or nothing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from starlette.types import Receive, Scope, Send

from backend.access.rules import READ, RULES
from backend.batch import service
from backend.batch.service import TOGETHER
from backend.db.tables import Run
from backend.http.outage import DatabaseOutage
from tests.api.conftest import running
from tests.given.databases import Fresh
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.submissions import submit

API = "/api/v1"


def batch(client: httpx.Client, *paths: str) -> dict[str, tuple[str | None, Any]]:
    """By path below the API: the entity tag and the document."""
    answer = client.get(f"{API}/batch", params=[("path", path) for path in paths])
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("application/jsonl")
    lines = answer.text.splitlines()
    heads = [json.loads(line) for line in lines[::2]]
    return {head["path"]: (head["etag"], json.loads(body)) for head, body in zip(heads, lines[1::2], strict=True)}


@pytest.fixture(scope="module")
def run(still: Service, guest: httpx.Client) -> str:
    run = submit(guest)
    finish_fully(still)
    return run


def paths_of(run: str) -> list[str]:
    """Every address that can be asked for together."""
    return sorted(path.removeprefix(API).format(run=run, name="F1") for path in TOGETHER)


def test_each_answers_as_it_does_alone_in_the_order_of_the_paths(guest: httpx.Client, run: str) -> None:
    paths = [*paths_of(run)[::-1], f"/runs/{run}/evaluations?max_points=2", "/runs?limit=1&q=no%20such%26run"]
    found = batch(guest, *paths[:10]) | batch(guest, *paths[10:])
    assert [*found] == [API + path for path in paths]
    assert len(paths) == len(TOGETHER) + 2
    for path, (tag, document) in found.items():
        alone = guest.get(path)
        assert (alone.status_code, alone.headers.get("etag")) == (200, tag), path
        assert path.endswith("/workers") or alone.json() == document, path  # workers state the time
    assert found[f"{API}/runs/{run}"][0]


def test_all_of_them_may_be_read_by_every_user() -> None:
    assert {RULES["GET", path] for path in TOGETHER} == {READ}


@pytest.mark.parametrize(
    "path",
    ["/runs/R-9999", "/runs/R-9999/stages", "/events", "/batch?path=/session", "/users", "/nowhere", "session", "",
     "//x", "/runs?limit=0", "/runs/%00", "/runs/R-0001/report.html", "/runs/R-0001/coverage", "/é?ü=%ff"],
)  # fmt: skip
def test_what_is_refused_or_is_no_short_document_is_left_out(guest: httpx.Client, run: str, path: str) -> None:
    assert [*batch(guest, "/session", path, f"/runs/{run}")] == [f"{API}/session", f"{API}/runs/{run}"]


def test_what_fails_is_left_out(still: Service, guest: httpx.Client, run: str) -> None:
    with changed(still.engine, sa.update(Run).values(summary={"verdict": "cleared", "version": 99})):
        assert guest.get(f"{API}/runs/{run}").status_code == 409
        assert [*batch(guest, f"/runs/{run}", "/session")] == [f"{API}/session"]


def test_it_needs_a_sign_in_and_a_few_paths(still: Service, guest: httpx.Client) -> None:
    with still.visitor() as stranger:
        problem(stranger.get(f"{API}/batch", params={"path": "/session"}), 401)
    problem(guest.get(f"{API}/batch"), 422)
    problem(guest.get(f"{API}/batch", params=[("path", "/session")] * 17), 422)


def test_each_counts_as_a_request(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    with running(fresh_sqlite, tmp_path, max_requests_per_minute=60) as own, own.signed_in() as client:
        paths = [f"/runs?limit={limit}" for limit in range(1, 16)]
        answered = [len(batch(client, *paths)) for _ in range(4)]
        assert answered[:3] == [15, 15, 15]
        assert answered[3] < 15, "a session has four fifths of the rate of its user"
        problem(client.get(f"{API}/session"), 429)


def test_each_is_in_the_access_log_and_in_the_metrics(
    fresh_sqlite: Fresh, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with running(fresh_sqlite, tmp_path, access_log=True) as own, own.signed_in() as client:
        with caplog.at_level("INFO", "clearance.access"):
            assert [*batch(client, "/session", "/runs/R-9999")] == [f"{API}/session"]
        ended = [line.split()[3:6] for line in caplog.messages if "/api/v1/" in line]
        metrics = client.get("/metrics").text
    assert ended[:2] == [["GET", f"{API}/session", "200"], ["GET", f"{API}/runs/R-9999", "404"]]
    assert 'clearance_request_seconds_count{method="GET",route="/api/v1/runs/{run}",status="4xx"} 1' in metrics


def logged(caplog: pytest.LogCaptureFixture) -> list[tuple[str, object]]:
    return [(one.levelname, one.args) for one in caplog.records if one.name == service.__name__]


def test_a_database_that_cannot_be_used_is_left_to_the_requests_themselves(
    still: Service, guest: httpx.Client, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async def away(*_: object) -> None:
        raise DatabaseOutage("database-away", "The database is away.", ConnectionError(), False)

    monkeypatch.setitem(still.app.state._state, "alone", away)
    assert batch(guest, "/session", "/workers") == {}
    assert logged(caplog) == []


def test_an_error_of_the_service_is_logged_and_takes_nothing_else_along(
    still: Service, guest: httpx.Client, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    alone = still.app.state.alone

    async def broken(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["path"].endswith("/workers"):
            raise ValueError("broken")
        await alone(scope, receive, send)

    monkeypatch.setitem(still.app.state._state, "alone", broken)
    assert [*batch(guest, "/workers", "/session")] == [f"{API}/session"]
    assert logged(caplog) == [("ERROR", (f"{API}/workers",))]
