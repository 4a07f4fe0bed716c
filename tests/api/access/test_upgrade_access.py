"""A database that revision 0017 wrote: its session, tokens and audit trail still hold after the migration.

`stored/revision-0017.sqlite3.gz` was written by the code of that revision: the token `ci`, the revoked token `old`, a
session of the login link that ends in 2096, and four rows of the audit trail.
"""

from __future__ import annotations

import gzip
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest

from backend.db import audit
from backend.db.engine import connect, default_url, migrate
from backend.settings import Settings
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit

STORED = Path(__file__).parents[1] / "stored" / "revision-0017.sqlite3.gz"
TRAIL = "select id, at, user, via, action, subject, detail from audit order by id"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    return tmp_path


@pytest.fixture
def service(folder: Path) -> Iterator[Service]:
    migrate(default_url(folder))
    service = Service(Settings(data=folder, pages=folder / "dist"))
    service.publish()
    service.start()
    yield service
    service.stop()


def trail(folder: Path) -> list[tuple[object, ...]]:
    with sqlite3.connect(folder / "clearance.sqlite3") as connection:
        return connection.execute(TRAIL).fetchall()


def test_tokens_and_sessions_can_do_what_they_could(service: Service) -> None:
    with service.visitor(authorization="Bearer clr_of-revision-0017") as program:
        found = program.get("/api/v1/session").json()
        assert (found["user"], found["account"], found["role"], found["scope"]) == ("ci", "local", "admin", "admin")
        run = submit(program)
        assert program.post(f"/api/v1/runs/{run}/cancel").json()["state"] == "cancelled"
        assert program.delete(f"/api/v1/runs/{run}", params={"reason": "x"}).status_code == 200
        assert program.post(f"/api/v1/runs/{run}/restore").status_code == 200
    with service.visitor(cookie=f"{service.settings.cookie}=cookie-of-revision-0017") as browser:
        assert browser.get("/api/v1/session").json()["role"] == "admin"
        (mine,) = browser.get("/api/v1/sessions").json()
        assert (mine["agent"], mine["address"], mine["current"]) == ("", "", True)
        assert [one["state"] for one in browser.get("/api/v1/tokens").json()] == ["revoked", "active"]
    with service.visitor(authorization="Bearer clr_revoked") as program:
        problem(program.get("/api/v1/session"), 401)


def test_the_trail_keeps_its_rows_and_becomes_a_chain(folder: Path) -> None:
    before = trail(folder)
    assert len(before) == 4
    migrate(default_url(folder))
    assert trail(folder) == before
    engine = connect(default_url(folder))
    with engine.begin() as writer:
        assert audit.verified(writer).faults == []
        assert audit.head(writer).row == 4
        audit.note_command(writer, "operator", "login_link.made", "local", {})
        assert audit.verified(writer).head.row == 5
    engine.dispose()
