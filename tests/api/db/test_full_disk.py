"""A disk that is full, and a database that another process has locked: a sentence, and nothing half done."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from clearance.cli import INTERNAL, invoke
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

FILES = "/api/v1/requirements/files"
LARGE = b"id,text\n" + b"".join(b"R%d,%s\n" % (i, b"x" * 900) for i in range(500))


@contextmanager
def full(engine: sa.Engine) -> Iterator[None]:
    """No connection of the engine can make the database larger."""

    def limited(connection: Any, *_: Any) -> None:
        (pages,) = connection.execute("PRAGMA page_count").fetchone()
        connection.execute(f"PRAGMA max_page_count={pages}")

    def free(connection: Any, *_: Any) -> None:
        connection.execute("PRAGMA max_page_count=1000000")

    sa.event.listen(engine, "checkout", limited)
    try:
        yield
    finally:
        sa.event.remove(engine, "checkout", limited)
        sa.event.listen(engine, "checkout", free)


def test_an_import_on_a_full_disk_is_refused_and_changes_nothing(service: Service, client: httpx.Client) -> None:
    where = {"kind": "csv", "name": "a.csv"}
    with full(service.app.state.engine):
        answer = client.post(FILES, params=where, content=LARGE)
        problem(answer, 503, "no-space")
        assert int(answer.headers["Retry-After"]) > 0
        assert client.get(FILES).json() == []
        assert client.get("/api/v1/requirements").json()["total"] == 0
    assert client.post(FILES, params=where, content=LARGE).status_code == 201


@pytest.mark.nightly
def test_a_service_is_not_ready_from_a_write_without_space_until_one_succeeds(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether the database cannot grow or nothing can be written next to it."""
    service.compare()
    ready = "/api/v1/health/ready"

    def missing() -> list[str]:
        answer = client.get(ready)
        return [] if answer.status_code == 200 else [error["field"] for error in answer.json()["errors"]]

    assert missing() == []
    state = service.app.state
    with full(state.engine), full(state.door._engine):
        assert missing() == [], "no write has failed"
        problem(client.post(FILES, params={"kind": "csv", "name": "a.csv"}, content=LARGE), 503, "no-space")
        assert missing() == missing() == ["no-space"]
    with monkeypatch.context() as patched:
        patched.setattr(tempfile, "TemporaryFile", _refused)
        assert missing() == ["no-space"]
    assert missing() == missing() == []
    with service.engine.connect() as connection:
        assert not sa.inspect(connection).has_table("space_that_is_tried")


def _refused(*_: object, **__: object) -> None:
    raise OSError(28, "No space left on device")


def test_a_command_on_an_unusable_database_ends_with_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["token", "create", "one", "--data", str(tmp_path)]) == 0

    def refuse(connection: Any, *_: Any) -> None:
        connection.execute("PRAGMA query_only=ON")

    sa.event.listen(sa.Engine, "checkout", refuse)
    try:
        capsys.readouterr()
        assert invoke(["token", "create", "two", "--data", str(tmp_path)]) == INTERNAL
    finally:
        sa.event.remove(sa.Engine, "checkout", refuse)
    assert capsys.readouterr().err.endswith(" (attempt to write a readonly database)\n")


def test_a_file_for_which_there_is_no_temporary_space_is_refused(
    service: Service, client: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = submit(client)
    finish_fully(service)
    record = f"/api/v1/runs/{run}/exports/record.sqlite3"
    assert client.get(record).content.startswith(b"SQLite format 3")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "full"))
    problem(client.get(record), 503, "no-space")
