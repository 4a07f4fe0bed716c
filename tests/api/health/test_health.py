"""The service as monitoring sees it: alive, ready or why not, its metrics, and no new run without space."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db import engine, space
from backend.db.engine import now
from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import Run
from backend.db.workers import STILL
from backend.settings import Settings
from campaigns.runs import RunState
from campaigns.stored.records import StagePlan
from tests import results
from tests.faults.cases import columns
from tests.given.databases import Fresh
from tests.given.openapi_document import DOCUMENT, held
from tests.given.outages import moved
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

LIVE, READY = "/api/v1/health/live", "/api/v1/health/ready"


@pytest.mark.parametrize("rest", ["", "/live", "/ready"])
def test_a_health_check_finds_it_where_such_checks_look_first(service: Service, rest: str) -> None:
    service.compare()
    with service.visitor() as client:
        here, there = client.get(f"/health{rest}"), client.get(f"/api/v1/health{rest}")
    assert (here.status_code, here.json()) == (there.status_code, there.json()) == (200, {"status": "ok"})


def reasons(client: httpx.Client) -> list[str]:
    """What is missing; empty if the service is ready."""
    answer = client.get(READY)
    held(answer, DOCUMENT["paths"][READY]["get"])
    if answer.status_code == 200:
        return []
    document: Any = problem(answer, 503, "not-ready")
    assert int(answer.headers["Retry-After"]) > 0
    return [error["field"] for error in document["errors"]]


def test_ready_says_what_is_missing(service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with service.visitor() as client:
        assert reasons(client) == ["workers"]
        service.compare()
        assert reasons(client) == []
        with service.engine.begin() as connection:
            connection.execute(sa.text("update alembic_version set version_num = '0001'"))
        assert reasons(client) == ["schema"]
        with monkeypatch.context() as patched:
            patched.setattr(engine.os, "access", lambda *_: False)
            assert reasons(client) == ["schema", "database-away"]
        with moved(Path(str(service.engine.url.database))):
            assert reasons(client) == ["database-gone"]
            assert client.get(LIVE).status_code == 200
        monkeypatch.setattr(space.shutil, "disk_usage", lambda _: SimpleNamespace(free=1000))
        assert reasons(client) == ["space", "schema"]
        shutil.rmtree(service.settings.data)
        assert reasons(client)[0] == "folder"
        assert str(tmp_path) not in client.get(READY).text


def test_nothing_is_begun_without_space_and_what_runs_is_read(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = submit(client)
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(state="failed"))
    body = {"campaign": campaign(), "path": "vehicle.m", "values": [1.0]}
    with monkeypatch.context() as patched:
        patched.setattr(space.shutil, "disk_usage", lambda _: SimpleNamespace(free=499_999_999))
        for path, document in (("runs", body), ("sweeps", body), (f"runs/{run}/retry", None)):
            answer = client.post(f"/api/v1/{path}", json=document)
            detail = str(problem(answer, 503, "no-space")["detail"])
            assert "500 MB (CLEARANCE_MIN_FREE)" in detail
            assert int(answer.headers["Retry-After"]) > 0
            held(answer, DOCUMENT["paths"][f"/api/v1/{path}".replace(run, "{run}")]["post"])
        assert client.get(f"/api/v1/runs/{run}").status_code == 200
        assert client.post("/api/v1/drafts", json={"name": "", "text": "name:"}).status_code == 201
    assert client.post(f"/api/v1/runs/{run}/retry").status_code == 200


def scraped(client: httpx.Client) -> dict[str, float]:
    """The samples by name and labels, in the text format 0.0.4."""
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    found, typed = {}, ""
    for line in answer.text.splitlines():
        if line.startswith("# "):
            kind = re.fullmatch(r"# (HELP \w+ \S.*|TYPE (\w+) (?:gauge|counter|histogram))", line)
            assert kind, line
            typed = kind[2] or typed
            continue
        sample = re.fullmatch(r'(\w+(?:\{\w+="[^"]*"(?:,\w+="[^"]*")*\})?) (\S+)', line)
        assert sample, line
        assert sample[1].startswith(typed), line
        assert sample[1] not in found
        found[sample[1]] = float(sample[2])
    return found


def test_metrics_count_what_there_is(service: Service, client: httpx.Client) -> None:
    for seed in range(1, 5):
        submit(client, seed=seed)
    away = {"state": "done", "removed": 1.0}
    several = ({"state": "running", "evaluations": 7, "losses": 2}, {}, away | {"evaluations": 11})
    with service.engine.begin() as connection:
        for i, values in enumerate((*several, away | {"evaluations": 100, "purged": 2.0}), start=1):
            connection.execute(sa.update(Run).where(Run.id == i).values(id=i, **values))
    service.compare()
    assert client.get("/api/v1/runs/R-0099").status_code == 404
    assert client.get("/api/v1/nowhere").status_code == 404
    found = scraped(client)
    listed = client.get("/api/v1/runs").json()["counts"]
    for state in RunState:
        assert found[f'clearance_runs{{state="{state}"}}'] == listed[state]
    assert listed["total"] == listed["queued"] + listed["running"] == 2
    assert found["clearance_evaluations"] == 7 + 11, "those of the removed run are there, those of the purged one not"
    assert found["clearance_run_losses"] == 2
    assert found['clearance_workers{state="alive"}'] == 1
    queues = ("pdf", "preview", "files", "imports", "recordings")
    assert {key: found[key] for key in found if key.startswith("clearance_jobs")} == {
        f'clearance_jobs{{queue="{queue}"}}': 0 for queue in queues
    }
    assert found["clearance_free_bytes"] > 0
    assert found["clearance_database_up"] == 1
    route = 'method="GET",route="/api/v1/runs/{run}",status="4xx"'
    assert found[f"clearance_request_seconds_count{{{route}}}"] == 1
    assert found[f'clearance_request_seconds_bucket{{{route},le="+Inf"}}'] == 1
    assert found["clearance_runs_standing_still"] == 0


def test_a_service_knows_at_its_first_scrape_that_a_run_stands_still(service: Service, client: httpx.Client) -> None:
    """By what the run itself stores, while it is claimed, put back, and claimed again."""
    submit(client)
    queue = Queue(service.engine)

    def still(ago: float) -> float:
        with service.engine.begin() as connection:
            connection.execute(sa.update(Run).values(advanced=now(connection) - ago))
        number = scraped(client)["clearance_runs_standing_still"]
        assert len(client.get("/api/v1/workers").json()["still"]) == number
        return number

    assert still(STILL + 1) == 0, "it is queued"
    claim = queue.claim("w")
    assert claim is not None
    assert scraped(client)["clearance_runs_standing_still"] == 0, "it has begun just now"
    assert still(STILL + 1) == 1
    assert still(STILL - 60) == 0
    store = RunStore(service.engine, claim)
    store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", 100)])
    assert still(STILL + 1) == 1
    store.append(0, 0, columns(0, 1))
    assert scraped(client)["clearance_runs_standing_still"] == 0, "it has a new evaluation"
    assert still(STILL + 1) == 1
    store.finish(0, results.nominal(), 0.01)
    assert scraped(client)["clearance_runs_standing_still"] == 0, "it has ended a stage"
    assert still(STILL + 1) == 1
    queue.lost(claim, "its worker was killed", delay=0.0)
    again = queue.claim("w")
    assert again is not None
    assert scraped(client)["clearance_runs_standing_still"] == 1, "another attempt is no evaluation"
    queue.give_back(again)
    with service.engine.begin() as connection:
        connection.execute(sa.update(Run).values(losses=0))
    assert queue.claim("w") is not None
    assert scraped(client)["clearance_runs_standing_still"] == 0, "it has only waited"


def test_metrics_need_a_token_unless_they_are_open(service: Service, fresh: Fresh, tmp_path: Path) -> None:
    with service.visitor() as client:
        assert client.get("/metrics").status_code == 401
        assert client.get("/metrics", headers={"Authorization": f"Bearer {service.token()}"}).status_code == 200
    with _open(fresh, tmp_path / "open") as other, other.visitor() as client:
        assert scraped(client)["clearance_database_up"] == 1
        with moved(Path(str(other.engine.url.database))):
            assert scraped(client)["clearance_database_up"] == 0


@contextmanager
def _open(fresh: Fresh, folder: Path) -> Iterator[Service]:
    folder.mkdir()
    data = folder / "data"
    service = Service(Settings(data=data, database=fresh(data), pages=folder, metrics_open=True))
    service.start()
    try:
        yield service
    finally:
        service.stop()
