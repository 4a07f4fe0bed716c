"""Every command that opens a database meets a damaged one: one sentence, an exit code, no SQL, nothing changed."""

from __future__ import annotations

import hashlib
import shutil
import signal
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import typer

from backend.db.damage import damage
from backend.db.engine import connect, default_url, read
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from backend.db.tables import Run
from campaigns.stored.records import StagePlan
from clearance.cli import INTERNAL, WRONG_INPUT, build, invoke
from tests import results
from tests.faults.cases import campaign, columns
from tests.faults.long import case
from tests.faults.processes import kill, until, worker
from tests.given.outages import checkpoint
from tests.migrated import migrated

NEW = "{folder}/new"
WORDS: dict[str, list[str]] = {
    "audit head": [],
    "audit run": ["R-0001"],
    "audit verify": [],
    "backup": [NEW],
    "check-simulator": ["nothing"],
    "doctor": [],
    "login-link": [],
    "purge": ["--older-than", "0d", "--size", "1kB", "--yes"],
    "replay": ["R-0001"],
    "restore": ["{folder}/clearance.sqlite3", "--yes"],
    "run": ["--continue", "R-0001", "--budget", "+100"],
    "serve": ["--port", "0"],
    "token create": ["ci"],
    "token list": [],
    "token revoke": ["ci"],
    "trail head": [],
    "trail verify": [],
    "verify": ["R-0001"],
    "worker": [],
    "worker drain": ["w"],
}
"""Arguments of every command that opens a database."""
LASTING = {"serve", "worker"}
"""What does not end by damage that it meets later: a service answers with it, a worker puts its run off."""
WITHOUT = {"check-simulator"}
"""What ends before by another mistake."""


def commands() -> set[str]:
    """The commands with an option for the database."""

    def below(command: Any, path: tuple[str, ...]) -> Iterator[str]:
        if any("--database" in parameter.opts for parameter in command.params) and path != ("audit",):
            yield " ".join(path)
        for name, one in getattr(command, "commands", {}).items():
            yield from below(one, (*path, name))

    return set(below(typer.main.get_command(build()), ()))


def test_the_list_has_every_command() -> None:
    assert commands() == set(WORDS)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a finished run, and one that failed."""
    folder = tmp_path_factory.mktemp("whole")
    engine = connect(migrated(folder))
    for _ in range(2):
        with engine.begin() as writer:
            submit(writer, campaign(), name="one", tags=[], owner="", planned=1)
    for name in ("done", "failed"):
        claim = Queue(engine).claim("w")
        assert claim is not None
        store = RunStore(engine, claim)
        store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", 100)])
        store.begin(0)
        store.append(0, 0, columns(0, 1))
        store.finish(0, results.nominal(), 0.01)
        store.begin(1)
        store.append(1, 0, columns(0, 100))
        if name == "done":
            store.finish(1, results.searched(), 1.0)
            store.conclude(results.verdict())
        else:
            Queue(engine).fail(claim, "it was stopped")
    checkpoint(engine)
    engine.dispose()
    folder.chmod(0o700)
    return folder


@pytest.fixture
def folder(whole: Path, tmp_path: Path) -> Path:
    return shutil.copytree(whole, tmp_path / "data")


def garbage(file: Path) -> None:
    file.write_bytes(b"no database at all " * 1000)


def torn(file: Path) -> None:
    """Every page is overwritten but those of the schema and of its revision."""
    with closing(sqlite3.connect(file)) as connection:
        (size,) = connection.execute("PRAGMA page_size").fetchone()
        of = "select rootpage from sqlite_master where rootpage > 0 and tbl_name <> 'alembic_version'"
        pages = [page for (page,) in connection.execute(of)]
    with file.open("r+b") as content:
        for page in pages:
            content.seek((page - 1) * size)
            content.write(b"\xff" * size)


DAMAGE = {"garbage": garbage, "torn": torn}


@pytest.mark.by_day(8)
@pytest.mark.parametrize("how", DAMAGE)
@pytest.mark.parametrize("command", sorted(WORDS))
def test_a_command_says_in_one_sentence_that_the_database_is_damaged(
    command: str, how: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if command in WITHOUT or (how == "torn" and command in LASTING):
        return
    file = folder / "clearance.sqlite3"
    DAMAGE[how](file)
    before = hashlib.sha256(file.read_bytes()).hexdigest()
    words = [word.format(folder=folder) for word in WORDS[command]]
    code = invoke([*command.split(), *words, "--data", str(folder)])
    out, err = capsys.readouterr()
    said = out if command == "doctor" else err
    assert code == (1 if command == "doctor" else WRONG_INPUT if command in ("backup", "restore") else INTERNAL), said
    assert "Traceback" not in said
    assert not any(word in said for word in ("[SQL", "SELECT", "INSERT", "UPDATE", "sqlalche.me", "parameters")), said
    assert any(word in said for word in ("damaged", "malformed", "not a database")), said
    if command != "doctor":
        assert len([line for line in said.splitlines() if not line.startswith("Note: ")]) == 1, said
    assert hashlib.sha256(file.read_bytes()).hexdigest() == before
    assert not Path(NEW.format(folder=folder)).exists()


def test_the_whole_database_is_read_by_them(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What the test above shows is the damage, not another mistake in its arguments."""
    url = default_url(folder)
    for command in ("backup", "purge", "token list", "trail verify"):
        words = [word.format(folder=folder) for word in WORDS[command]]
        code = invoke([*command.split(), *words, "--data", str(folder)])
        assert code in (0, 1), capsys.readouterr().err
    engine = connect(url)
    with read(engine) as reader:
        assert reader.scalar(Run.__table__.select().with_only_columns(Run.attempts)) is not None
    engine.dispose()


@pytest.mark.nightly
def test_a_worker_under_which_files_are_deleted_stops_writing_and_another_goes_on(tmp_path: Path) -> None:
    """Those beside the SQLite file: what was stored is there, and no attempt is used up."""
    url = migrated(tmp_path)

    def run() -> Any:
        engine = connect(url)  # one that stays open would keep the deleted files
        try:
            with read(engine) as reader:
                return reader.execute(Run.__table__.select()).one()
        finally:
            engine.dispose()

    engine = connect(url)
    with engine.begin() as writer:
        submit(writer, case(), name="long", tags=[], owner="", planned=0)
    engine.dispose()
    file = tmp_path / "clearance.sqlite3"
    with worker(url, tmp_path, "first", "--lease", "2") as first:
        until(lambda: run().evaluations > 2000, first.text())
        for ending in ("-wal", "-shm"):
            file.with_name(file.name + ending).unlink()
        until(lambda: "files of the database were deleted" in first.text(), first.text(), 15.0)
        kill(first.pid, number=signal.SIGTERM)
        first.process.wait(30)
    assert damage(file) == ""
    stored = run().evaluations
    assert stored > 2000
    with worker(url, tmp_path, "second", "--lease", "2") as second:
        until(lambda: run().evaluations > stored, second.text())
        assert run().attempts == 1
