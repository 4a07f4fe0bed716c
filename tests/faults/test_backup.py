"""Backup and restore while runs write, and what `clearance doctor` says of a broken installation."""

from __future__ import annotations

import os
import shutil
import sqlite3
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic import command

from backend.db import access, revision, users
from backend.db.backup import BackupError, backup, restore
from backend.db.damage import damage
from backend.db.engine import connect, default_url, migrate, read
from backend.db.migrate import config
from backend.db.queue import LostLease, Queue, submit
from backend.db.roles import LOCAL
from backend.db.tables import Base, Run
from campaigns.stages.plan import most
from clearance.cli import WRONG_INPUT, invoke
from tests.audited import audited
from tests.faults import postgres
from tests.faults.diagnosed import diagnosed
from tests.faults.long import case
from tests.faults.processes import until, worker
from tests.faults.serving import state
from tests.given.at_night import nightly_but
from tests.given.databases import AT_NIGHT
from tests.migrated import migrated


def queued(engine: sa.Engine) -> int:
    with engine.begin() as connection:
        return submit(connection, case(), name="long", tags=[], owner="", planned=most(case()))


@pytest.mark.nightly  # by day each part: what is backed up, what is restored, a run that goes on after its worker
def test_a_backup_made_while_a_run_writes_goes_on_where_it_was(database: sa.Engine, tmp_path: Path) -> None:
    url = database.url.render_as_string(hide_password=False)
    run_id, file = queued(database), tmp_path / "backup"
    with worker(url, tmp_path, "first") as running:
        until(lambda: state(database, run_id).evaluations > 3000, "well under way")
        stopped_at = state(database, run_id).evaluations
        assert backup(url, file) == file.stat().st_size
        until(lambda: state(database, run_id).evaluations > stopped_at, "the run has gone on")
        with pytest.raises(BackupError, match=r"in use"):
            restore(url, file)
        assert running.process.poll() is None
    with database.begin() as connection:
        connection.execute(sa.text("delete from workers"))  # as after an orderly end
    database.dispose()
    former = restore(url, file).former
    assert (former is not None) == (database.dialect.name == "sqlite")
    again = state(database, run_id)
    assert (again.state, again.evaluations >= stopped_at) == ("running", True)
    with worker(url, tmp_path, "second", "--lease", "2"):
        until(lambda: state(database, run_id).state == "done", "the run ends", 180)
    if database.dialect.name == "sqlite":
        audited(database, run_id=run_id)


@pytest.fixture
def stored(tmp_path: Path) -> str:
    """A database with one run."""
    url = migrated(tmp_path / "data")
    engine = connect(url)
    queued(engine)
    engine.dispose()
    return url


def runs(url: str) -> int:
    engine = connect(url)
    try:
        with read(engine) as connection:
            return connection.scalar(sa.select(sa.func.count()).select_from(Run)) or 0
    finally:
        engine.dispose()


def cut_off(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def overwritten(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[4096 : 4096 * 3] = b"\xff" * 4096 * 2
    file.write_bytes(bytes(content))


def of_another_program(file: Path) -> None:
    file.unlink()
    engine = sa.create_engine(f"sqlite:///{file}")
    with engine.begin() as connection:
        connection.execute(sa.text("create table notes (text text)"))
    engine.dispose()


def newer(file: Path) -> None:
    engine = sa.create_engine(f"sqlite:///{file}")
    with engine.begin() as connection:
        connection.execute(sa.text("update alembic_version set version_num = '9999'"))
    engine.dispose()


@pytest.mark.parametrize(
    "spoil", [cut_off, overwritten, of_another_program, newer, lambda file: file.write_text("hello"), Path.unlink]
)
def test_what_is_no_backup_replaces_nothing(stored: str, tmp_path: Path, spoil: Callable[[Path], object]) -> None:
    file = tmp_path / "backup"
    backup(stored, file)
    spoil(file)
    with pytest.raises(BackupError):
        restore(stored, file)
    assert runs(stored) == 1


@pytest.mark.parametrize("spoil", [cut_off, overwritten])
def test_no_backup_is_made_of_a_damaged_database_and_what_is_damaged_is_said(
    stored: str, tmp_path: Path, spoil: Callable[[Path], object]
) -> None:
    database = Path(stored.removeprefix("sqlite:///"))
    spoil(database)  # the last connection has written everything into the file
    with pytest.raises(BackupError) as refused:
        backup(stored, tmp_path / "copy")
    assert str(database) in str(refused.value)
    assert ".part" not in str(refused.value)
    assert damage(database) in str(refused.value)


@pytest.mark.parametrize("left", [(), ("-journal", "-wal", "-shm")])
def test_a_backup_that_fails_leaves_no_file(
    left: tuple[str, ...], stored: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor does it take over what a killed one left."""
    folder = tmp_path / "copies"
    folder.mkdir()
    for ending in left:
        (folder / f".copy.part{ending}").write_bytes(b"of a killed one")

    def full(source: Path, part: Path) -> None:
        assert [path.name for path in folder.iterdir()] == [part.name]
        for ending in ("", "-journal"):
            part.with_name(part.name + ending).write_bytes(b"some")
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("backend.db.backup._copy_sqlite", full)
        with pytest.raises(BackupError, match="No space left"):
            backup(stored, folder / "copy")
    assert list(folder.iterdir()) == []
    backup(stored, folder / "copy")
    assert [path.name for path in folder.iterdir()] == ["copy"]


def test_a_damaged_database_is_replaced(stored: str, tmp_path: Path) -> None:
    file, database = tmp_path / "backup", tmp_path / "data" / "clearance.sqlite3"
    backup(stored, file)
    overwritten(database)
    assert restore(stored, file).former is not None
    assert runs(stored) == 1


def renamed(file: Path, *pragmas: str) -> Generator[None]:
    """Writes another name of the run, and stops as a killed process does: what it left is of the moment."""
    with closing(sqlite3.connect(file, isolation_level=None)) as connection:
        for pragma in pragmas:
            connection.execute(f"pragma {pragma}").fetchall()
        connection.execute("begin immediate")
        connection.execute("update runs set name = 'later'")
        yield
        connection.execute("commit")
        yield


def left_behind(file: Path, ending: str) -> bytes:
    """What a killed process leaves next to a database: a log of what it wrote, or a journal of what was before."""
    if ending == "-journal":
        steps = renamed(file, "journal_mode=delete", "synchronous=off")
    else:
        steps = renamed(file, "journal_mode=wal", "wal_autocheckpoint=0")
        next(steps)
    next(steps)
    left = file.with_name(file.name + ending).read_bytes()
    for _ in steps:
        pass
    assert left
    return left


def names(file: Path) -> list[str]:
    with closing(sqlite3.connect(file)) as connection:
        return [name for (name,) in connection.execute("select name from runs")]


@pytest.mark.by_day(4)
@pytest.mark.parametrize("there", ["nothing", "empty", "damaged", "whole"])
@pytest.mark.parametrize("ending", ["-wal", "-shm", "-journal"])
def test_a_restored_database_is_the_backup_whatever_is_left_of_the_former_one(
    stored: str, tmp_path: Path, ending: str, there: str
) -> None:
    database = tmp_path / "data" / "clearance.sqlite3"
    with closing(sqlite3.connect(database)) as connection:
        connection.execute("pragma wal_checkpoint(truncate)")
        connection.execute("vacuum")  # so that page numbers are those of the backup, and what is played back fits it
    left = left_behind(database, ending)
    with closing(sqlite3.connect(database)) as connection:
        connection.execute("update runs set name = 'of the backup'")
        connection.commit()
    backup(stored, tmp_path / "backup")
    if there == "nothing":
        database.unlink()
    elif there == "empty":
        database.write_bytes(b"")
    elif there == "damaged":
        overwritten(database)
    database.with_name(database.name + ending).write_bytes(left)
    former = restore(stored, tmp_path / "backup").former
    assert names(database) == ["of the backup"]
    assert damage(database) == ""
    assert not database.with_name(database.name + ending).exists()
    assert former is not None
    assert former.exists()


def test_restores_within_one_second_keep_every_former_database(
    stored: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    backup(stored, tmp_path / "backup")
    monkeypatch.setattr("time.strftime", lambda _: "20260101-000000")
    former = {restore(stored, tmp_path / "backup").former for _ in range(3)}
    assert len(former) == 3
    assert all(file is not None and names(file) == ["long"] for file in former)


def test_a_former_database_is_restored_with_what_its_log_has(stored: str, tmp_path: Path) -> None:
    database, copy = tmp_path / "data" / "clearance.sqlite3", tmp_path / "copy"
    steps = renamed(database, "journal_mode=wal", "wal_autocheckpoint=0")
    next(steps)
    next(steps)
    for ending in ("", "-wal"):
        shutil.copyfile(f"{database}{ending}", f"{copy}{ending}")
    steps.close()
    restore(stored, copy)
    assert names(database) == ["later"]


def test_the_database_is_not_restored_from_itself(stored: str, tmp_path: Path) -> None:
    with pytest.raises(BackupError, match=r"the database itself"):
        restore(stored, tmp_path / "data" / "clearance.sqlite3")


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root")
@pytest.mark.parametrize("there", [True, False])
def test_what_root_restores_is_the_services(stored: str, tmp_path: Path, there: bool) -> None:
    file, database = tmp_path / "backup", tmp_path / "data" / "clearance.sqlite3"
    backup(stored, file)
    for path in (database.parent, database):
        os.chown(path, 10001, 10001)
    if not there:
        database.unlink()
    restore(stored, file)
    assert (database.stat().st_uid, database.stat().st_gid) == (10001, 10001)


def test_by_the_command_line(stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, file = ["--data", str(tmp_path / "data")], tmp_path / "backup"
    assert invoke(["backup", str(file), *data]) == 0
    assert invoke(["backup", str(file), *data]) == WRONG_INPUT, "it exists"
    shutil.rmtree(tmp_path / "data")
    assert invoke(["restore", str(file), "--yes", *data]) == 0
    assert invoke(["restore", str(tmp_path / "none"), "--yes", *data]) == WRONG_INPUT
    assert runs(stored) == 1
    assert (tmp_path / "data" / "clearance.sqlite3").stat().st_mode & 0o077 == 0
    assert capsys.readouterr().err


@pytest.mark.parametrize(
    ("spoil", "name", "state"),
    [
        (lambda data: None, "workers", "failed"),
        (shutil.rmtree, "data folder", "failed"),
        (lambda data: (data / "clearance.sqlite3").unlink(), "database", "failed"),
        (lambda data: overwritten(data / "clearance.sqlite3"), "database", "failed"),
        (lambda data: newer(data / "clearance.sqlite3"), "schema", "failed"),
        (lambda data: data.chmod(0o755), "data folder", "warning"),
    ],
)
def test_the_doctor_names_what_is_wrong_and_what_to_do(
    stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], spoil: Callable[[Path], object], name: str,
    state: str,
) -> None:  # fmt: skip
    """That it finds nothing wrong with what works: tests/faults/test_worker.py."""
    data = tmp_path / "data"
    data.chmod(0o700)
    spoil(data)
    code, found = diagnosed(data, capsys)
    assert (code, found[name]["state"]) == (1, state)
    assert found[name]["remedy"]
    assert all(one["remedy"] for one in found.values() if one["state"] != "ok")


@AT_NIGHT
def test_a_restore_lets_nobody_in_unseen(
    database: sa.Engine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What was ended since the backup is ended, or named."""
    url, file = database.url.render_as_string(hide_password=False), tmp_path / "backup"
    with database.begin() as writer:
        for token, revoked in (("leaked", False), ("gone", True)):
            access.create_token(writer, token)
            if revoked:
                access.revoke_token(writer, token)
        access.create_token(writer, "over", lifetime=-1.0)
        for user in ("eve", "left"):
            users.invite(writer, user, "admin", LOCAL)
        users.set_disabled(writer, "left", True)
        session, link = access.open_session(writer, "eve", "password"), access.create_login_code(writer)
    backup(url, file)
    with database.begin() as writer:
        access.revoke_token(writer, "leaked")
        users.set_disabled(writer, "eve", True)
    database.dispose()
    assert invoke(["restore", str(file), "--yes", "--database", url]) == 0
    told = capsys.readouterr().out
    assert [line.rpartition(": ")[2] for line in told.splitlines() if ": " in line] == ["leaked", "eve, local"]
    with database.begin() as writer:
        assert access.by_session(writer, session) is None
        assert not access.use_login_code(writer, link)
        for table in ("sessions", "login_links", "invitations"):
            assert writer.scalar(sa.text(f"select count(*) from {table}")) == 0


def test_a_backup_of_before_users_is_restored(tmp_path: Path) -> None:
    url, file = default_url(tmp_path / "data"), tmp_path / "backup"
    engine = connect(url)
    with engine.begin() as connection:
        command.upgrade(config(connection), "0017")
        connection.exec_driver_sql("insert into tokens (name, hash, created) values ('ci', 'x', 0.0)")
    engine.dispose()
    backup(url, file)
    assert restore(url, file)[:2] == (["ci"], [])


@pytest.fixture
def emptied(server: postgres.Server) -> Iterator[str]:
    """An empty PostgreSQL database."""
    engine = connect(server.url).execution_options(isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.exec_driver_sql("create database emptied")
    yield sa.make_url(server.url).set(database="emptied").render_as_string(hide_password=False)
    with engine.connect() as connection:
        connection.exec_driver_sql("drop database emptied with (force)")
    engine.dispose()


@pytest.mark.nightly
@pytest.mark.parametrize("earlier", nightly_but(("0030",), ("0017", "0020", "0030")))
def test_a_backup_of_before_an_update_is_restored_after_it(emptied: str, tmp_path: Path, earlier: str) -> None:
    """Also by the earlier version, which does not know all tables of the later one."""
    engine, file = connect(emptied), tmp_path / "backup"
    with engine.begin() as connection:
        command.upgrade(config(connection), earlier)
        connection.exec_driver_sql("insert into tokens (name, hash, created) values ('ci', 'x', 0.0)")
    backup(emptied, file)
    migrate(emptied)
    with engine.begin() as connection:
        connection.exec_driver_sql("delete from tokens")
        connection.exec_driver_sql("create table of_a_later_version (run integer references runs (id))")
        connection.exec_driver_sql("update alembic_version set version_num = '9999'")
    assert restore(emptied, file).tokens == ["ci"]
    with engine.begin() as connection:
        assert revision.stored(connection) == earlier
        assert not sa.inspect(connection).has_table("of_a_later_version")
    migrate(emptied)
    engine.dispose()


@pytest.mark.nightly
def test_tables_of_others_are_not_dropped_by_a_restore(emptied: str, tmp_path: Path) -> None:
    engine, file = connect(emptied), tmp_path / "backup"
    migrate(emptied)
    backup(emptied, file)
    with engine.begin() as connection:
        connection.exec_driver_sql("create table payroll (id integer)")
    with pytest.raises(BackupError, match="payroll"):
        restore(emptied, file)
    assert sa.inspect(engine).has_table("payroll")
    engine.dispose()


@pytest.mark.nightly
def test_the_tables_of_every_revision_are_known_as_clearances() -> None:
    engine, names = sa.create_engine("sqlite://", poolclass=sa.StaticPool), set[str]()
    for each in sorted(revision.known()):
        with engine.begin() as connection:
            command.upgrade(config(connection), each)
            names |= set(sa.inspect(connection).get_table_names())
    assert names == Base.metadata.tables.keys() | revision.FORMER_TABLES
    engine.dispose()


@pytest.mark.nightly
@pytest.mark.parametrize("spoil", [cut_off, lambda file: file.write_text("hello")], ids=["cut off", "no backup"])
def test_what_is_no_whole_backup_changes_nothing_on_postgresql(
    emptied: str, tmp_path: Path, spoil: Callable[[Path], object]
) -> None:
    file = tmp_path / "backup"
    migrate(emptied)
    queued(engine := connect(emptied))
    engine.dispose()
    backup(emptied, file)
    spoil(file)
    with pytest.raises(BackupError, match=r"^pg_restore failed: pg_restore: error: "):
        restore(emptied, file)
    assert runs(emptied) == 1


def test_a_worker_that_was_cut_off_does_not_hold_the_run_of_another_one_after_a_restore(
    stored: str, tmp_path: Path
) -> None:
    file = tmp_path / "backup"
    backup(stored, file)
    engine = connect(stored)
    cut_off = Queue(engine).claim("cut off")
    engine.dispose()
    restore(stored, file)
    engine = connect(stored)
    queue = Queue(engine)
    claim = queue.claim("another")
    assert cut_off is not None
    assert claim is not None
    assert claim.run_id == cut_off.run_id
    with pytest.raises(LostLease):
        queue.beat(cut_off)
    with pytest.raises(LostLease):
        queue.fail(cut_off, "it was cut off")
    assert not queue.beat(claim)
    engine.dispose()
