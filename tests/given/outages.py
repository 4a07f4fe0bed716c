"""Damages a database, and asks every route of a service while it cannot be used."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import httpx
import sqlalchemy as sa

from backend.access.rules import RULES
from tests.given.openapi_document import filled
from tests.given.problem_documents import problem

WITHOUT = {
    "/api/v1/campaigns/schema",
    "/api/v1/health/live",
    "/health/live",
    "/login/provider",
    "/login/provider/return",
}
"""Open routes that read no database."""
FORM = {"name": "ada", "password": "x" * 12, "code": "x"}


def every_route_is_away(client: httpx.Client, kind: str) -> None:
    asked = 0
    for method, path in RULES:
        if method == "SOCKET" or path in WITHOUT:
            continue
        form = FORM if path in ("/login", "/invite") else None
        answer = client.request(method, filled(path), data=form, follow_redirects=False)
        problem(answer, 503, "not-ready" if path.endswith("/ready") else kind)
        assert int(answer.headers["Retry-After"]) > 0, path
        assert not any(word in answer.text.lower() for word in ("sqlite", "select"))
        asked += 1
    assert asked > 90


@contextmanager
def torn(engine: sa.Engine, table: str) -> Iterator[None]:
    """The first page of a table and of its indices is overwritten in the file within the block."""
    checkpoint(engine)
    with closing(sqlite3.connect(str(engine.url.database))) as connection:
        pages = connection.execute("select rootpage from sqlite_master where tbl_name = ?", (table,)).fetchall()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
    engine.dispose()
    path = Path(str(engine.url.database))
    whole = path.read_bytes()
    _write(path, {(page - 1) * size: b"\xff" * size for (page,) in pages})
    try:
        yield
    finally:
        _write(path, {at: whole[at : at + size] for at in ((page - 1) * size for (page,) in pages)})


def _write(path: Path, parts: dict[int, bytes]) -> None:
    with path.open("r+b") as file:
        for at, part in parts.items():
            file.seek(at)
            file.write(part)


def checkpoint(engine: sa.Engine) -> None:
    """Everything that was committed is in the file itself."""
    with closing(sqlite3.connect(str(engine.url.database))) as connection:
        assert connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0] == 0


@contextmanager
def moved(file: Path) -> Iterator[None]:
    """The file has another name within the block."""
    file.rename(file.with_suffix(".away"))
    try:
        yield
    finally:
        file.with_suffix(".away").rename(file)
