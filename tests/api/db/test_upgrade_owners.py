"""What tokens did before they belonged to their users: after the migration it is the users', with the token's name.

`stored/revision-0019.sqlite3.gz` was written by the code of that revision.
"""

from __future__ import annotations

import gzip
import sqlite3
from pathlib import Path
from typing import Any

import pytest

from backend.db.engine import default_url, migrate

STORED = Path(__file__).parents[1] / "stored" / "revision-0019.sqlite3.gz"
TOKEN = "insert into tokens (name, hash, created, owner, scope) values (?, ?, 1, ?, 'admin')"
SIGNOFF = (
    "insert into signoffs (run_id, name, role, comment, digest, user, created) "
    "values ((select min(id) from runs), 'Grace', 'Review', '', ?, ?, 1)"
)
SWEEP = (
    "insert into sweeps (name, campaign_name, path, title, unit, body, owner, created) "
    "values ('s', 'c', 'p', 't', 'm', '', ?, 1)"
)
DRAFT = (
    "insert into drafts (version, name, tags, text, owner, created, saved, saved_by) "
    "values (1, '', '[]', '', ?, 1, 1, ?)"
)


@pytest.mark.parametrize(
    ("name", "user", "token"),
    [("robot", "ada", "robot"), ("ada", "ada", None), ("lost", "lost", None), ("", "", None)],
    ids=["a token", "a user", "a token that is not known", "nobody"],
)
def test_the_owner_is_the_user(tmp_path: Path, name: str, user: str, token: str | None) -> None:
    file = tmp_path / "clearance.sqlite3"
    file.write_bytes(gzip.decompress(STORED.read_bytes()))
    with sqlite3.connect(file) as connection:
        connection.execute("insert into users (name, role, created, created_by) values ('ada', 'engineer', 1, 'local')")
        connection.execute(TOKEN, ("robot", "0" * 64, "ada"))
        connection.execute("update runs set owner = ?", (name,))
        connection.execute("delete from signoffs")
        connection.execute(SIGNOFF, ("0" * 64, name))
        connection.execute(SWEEP, (name,))
        connection.execute(DRAFT, (name, name))
    migrate(default_url(tmp_path))

    def read(statement: str) -> set[Any]:
        with sqlite3.connect(file) as connection:
            return set(connection.execute(statement).fetchall())

    runs, sweeps = "select owner, token from runs", "select owner, token from sweeps where name = 's'"
    signed = "select user, account, texts from signoffs"
    assert read(runs) == {(user, token)}
    assert read(sweeps) == {(user, token)}
    assert (user, name) in read("select owner, saved_by from drafts")
    assert read(signed) == {(name, user, None)}
