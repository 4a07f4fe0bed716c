"""Copies a database into one file while runs write to it, and puts such a file in its place again.

SQLite: VACUUM INTO, which reads one snapshot and blocks no writer (its backup interface begins again with every write,
and so may never end). PostgreSQL: pg_dump, pg_restore and psql of its own packages.
"""

from __future__ import annotations

import itertools
import os
import secrets
import shutil
import sqlite3
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa

from backend.db import beside, numbers, revision, workers
from backend.db.damage import damage
from backend.db.engine import connect, connected, file_uri, now, read
from backend.db.private import create_private
from backend.db.tables import Base
from campaigns.refusals import Refusal

_ENDINGS = ("", *beside.ENDINGS, "-journal")
"""Of the files that SQLite takes for one database; the last is left by a crash while it is not in WAL mode."""


_EMPTY = b"""begin;
do $$ declare one record; begin
  for one in select format('%I.%I', schemaname, tablename) as name from pg_tables
    where schemaname = current_schema() and tableowner = current_user
  loop execute 'drop table if exists ' || one.name || ' cascade'; end loop;
  for one in select p.oid::regprocedure as name from pg_proc p join pg_namespace n on n.oid = p.pronamespace
    where n.nspname = current_schema() and p.prorettype = 'trigger'::regtype and p.proowner = current_user::regrole
  loop execute 'drop function ' || one.name; end loop;
end $$;
"""
"""Drops the tables and triggers of any version: those that a backup does not have would be in the way of its own."""


class BackupError(Refusal, ValueError):
    """Why there is no backup, or nothing was restored: a sentence."""


def backup(url: str, file: Path) -> int:
    """Copy the database into a new file, which appears when it is complete and on the disk; returns its size [bytes].

    Raises `BackupError`: the file exists, or the copy failed.
    """
    if file.exists():
        raise BackupError(f"{file} exists; give the name of a new file")
    part = file.with_name(f".{file.name}.part")
    try:
        _remove(part)
        create_private(part)
        if url.startswith("sqlite"):
            _copy_sqlite(_file_of(url), part)
        else:
            _tool(url, "pg_dump", "--format=custom", f"--file={part}", "{}")
        _on_disk(part)
        part.replace(file)
        _on_disk(file.parent)
    except OSError as error:
        raise BackupError(f"the backup could not be written to {file}: {error.strerror}") from None
    finally:
        _remove(part)
    return file.stat().st_size


class Restored(NamedTuple):
    """Who may use the service as of the backup, the names of valid tokens and of users who are not disabled; where the
    former SQLite file, or what was left of it, is now, if there was any; and the highest numbers before the
    restore, by table, above which new ones continue, None if the former database could not be read."""

    tokens: list[str]
    users: list[str]
    former: Path | None = None
    numbers: dict[str, int] | None = None


def restore(url: str, file: Path) -> Restored:
    """Put a backup in the place of the database.

    Runs that were active when the backup was made go on from what it has. Sessions, login links and unused invitations
    of then are deleted: they may have been ended since. New numbers of runs and others continue above those of the
    database that is replaced, if it can be read. Raises `BackupError`: the file is damaged, or
    of a newer version, or a service or worker uses the database, or others have tables in it. Nothing is changed then.
    """
    if not file.is_file():
        raise BackupError(f"there is no file {file}")
    if not url.startswith("sqlite"):
        _refuse_used(url)
        _refuse_shared(url)
        with connected(url) as engine:
            highest = numbers.of_server(engine)
        _replace_tables(url, file)
        return _prepared(connect(url), highest)
    _refuse_unusable(file)
    target = _file_of(url)
    if target.exists() and file.samefile(target):
        raise BackupError(f"{file} is the database itself; give a file of `clearance backup`")
    fresh = target.with_name(f".{target.name}.restored")
    try:
        with _unused(target) as replaced:
            highest = None if replaced is None else numbers.of_file(replaced)
            _remove(fresh)
            create_private(fresh)
            _copy_sqlite(file, fresh)  # with what its own -wal has, if it is no backup but a former database
            found = _prepared(sa.create_engine(f"sqlite:///{fresh}"), highest)
            _on_disk(fresh)
            _give_to_owner(fresh, target)
            former = _set_aside(target)
            fresh.replace(target)
            _on_disk(target.parent)
    except OSError as error:
        raise BackupError(f"the database {target} could not be replaced: {error.strerror}") from None
    finally:
        _remove(fresh)
    return found._replace(former=former)


def _prepared(engine: sa.Engine, highest: dict[str, int] | None) -> Restored:
    """Invalidate, in a restored database of any version, what may have ended since the backup was made."""
    try:
        with engine.begin() as writer:
            # A worker that was cut off must not hold the claim of one that claims the same run after the restore.
            writer.exec_driver_sql(f"update runs set fence = fence + {1000 + secrets.randbelow(100_000)}")
            tables = sa.inspect(writer).get_table_names()
            for table, which in (("sessions", ""), ("login_links", ""), ("invitations", " where used is null")):
                if table in tables:
                    writer.exec_driver_sql(f"delete from {table}{which}")
            valid = "revoked is null"
            if "expires" in {column["name"] for column in sa.inspect(writer).get_columns("tokens")}:
                valid += f" and (expires is null or expires > {now(writer)!r})"
            names = {
                table: list(writer.exec_driver_sql(f"select name from {table} where {which} order by name").scalars())
                for table, which in (("tokens", valid), ("users", "disabled is null"))
                if table in tables
            }
            above = None if highest is None else numbers.continue_above(writer, highest)
            return Restored(names.get("tokens", []), names.get("users", []), numbers=above)
    finally:
        engine.dispose()


def _remove(copy: Path) -> None:
    """Remove a copy, and what SQLite writes next to it: a copy that is made later must not find it."""
    for ending in _ENDINGS:
        copy.with_name(copy.name + ending).unlink(missing_ok=True)


def _copy_sqlite(source: Path, part: Path) -> None:
    part.unlink()  # VACUUM INTO makes the file, or takes one that is empty
    try:
        with closing(sqlite3.connect(file_uri(source, "ro"), uri=True, timeout=60.0)) as connection:
            connection.execute("VACUUM INTO ?", (str(part),))
        part.chmod(0o600)
    except sqlite3.Error as error:
        # SQLite may say that it cannot open the copy where it cannot read the original.
        wrong = damage(source) if source.exists() else ""
        why = f"is damaged and cannot be copied: {wrong}" if wrong else f"could not be copied: {error}"
        raise BackupError(f"{source} {why}") from None
    if wrong := damage(part):
        raise BackupError(f"the copy of {source} is damaged: {wrong}")


def _refuse_unusable(file: Path) -> None:
    if wrong := damage(file):
        raise BackupError(f"{file} is damaged and cannot be restored: {wrong}")
    with closing(sqlite3.connect(file_uri(file, "ro"), uri=True)) as connection:
        try:
            (found,) = connection.execute("select version_num from alembic_version").fetchone()
        except (sqlite3.DatabaseError, TypeError):
            raise BackupError(f"{file} is no database of Clearance") from None
    if found > revision.newest():
        raise BackupError(
            f"{file} was written by a newer version of Clearance (schema {found}, this one knows {revision.newest()}): "
            "install that version first"
        )


@contextmanager
def _unused(target: Path) -> Iterator[sqlite3.Connection | None]:
    """While the block lasts, no other process has the file: exclusive locking fails while another process has it
    open. Yields what reads it; None if there is none or it is damaged."""
    if not target.exists():
        yield None
        return
    in_use = BackupError(f"{target} is in use: stop the service and all workers first")
    with closing(sqlite3.connect(target, timeout=1.0, isolation_level=None)) as connection:
        try:
            connection.execute("PRAGMA locking_mode=EXCLUSIVE")
            if connection.execute("PRAGMA journal_mode=DELETE").fetchone()[0] == "wal":
                raise in_use
            connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            raise in_use from None
        except sqlite3.DatabaseError:
            yield None  # damaged: that is why it is replaced
            return
        yield connection


def _refuse_used(url: str) -> None:
    with connected(url) as engine, read(engine) as connection:
        known = sa.inspect(connection).has_table("workers")
        live = workers.live(connection) if known else []
    if live:
        raise BackupError(f"the database is in use by {', '.join(live)}: stop the service and all workers first")


def _refuse_shared(url: str) -> None:
    """A restore would drop the tables of others too. Those of a later version are not known, and dropped."""
    with connected(url) as engine, read(engine) as connection:
        later = (revision.stored(connection) or "") > revision.newest()
        own = "select tablename from pg_tables where schemaname = current_schema() and tableowner = current_user"
        tables = set(connection.scalars(sa.text(own)))
        others = tables - Base.metadata.tables.keys() - revision.FORMER_TABLES
    if others and not later:
        raise BackupError(
            f"a restore would drop tables that are not Clearance's: {', '.join(sorted(others))}. Move them, or restore "
            "into a new database"
        )


def _set_aside(target: Path) -> Path | None:
    """Give the file another name, and all that SQLite would play back into the one that takes its place: such files
    are there without it after a crash, when the file alone was moved or deleted."""
    if target.exists() and target.stat().st_size == 0:
        target.unlink()
    at = f"{target.name}.{time.strftime('%Y%m%d-%H%M%S')}"
    names = (at if number == 1 else f"{at}.{number}" for number in itertools.count(1))
    free = next(name for name in names if not any(target.with_name(name + ending).exists() for ending in _ENDINGS))
    moves = {target.with_name(target.name + ending): target.with_name(free + ending) for ending in _ENDINGS}
    moved = [file.rename(former) for file, former in moves.items() if file.exists()]
    return moved[0] if moved else None


def _give_to_owner(fresh: Path, target: Path) -> None:
    """Give the file to the user of the service if root made it: that user could not open it otherwise."""
    if os.geteuid() == 0:
        owner = (target if target.exists() else target.parent).stat()
        os.chown(fresh, owner.st_uid, owner.st_gid)


def _replace_tables(url: str, file: Path) -> None:
    """Replace all tables in one transaction, which ends only after a whole backup: psql takes the end of one that is
    cut off for the end of its input."""
    read_out, _ = _command(url, "pg_restore", "--clean", "--if-exists", "--no-owner", "--file=-", str(file))
    write_in, environment = _command(url, "psql", "--no-psqlrc", "--quiet", "--set=ON_ERROR_STOP=1", "--dbname={}")
    with tempfile.TemporaryFile("w+") as errors:
        reading = subprocess.Popen(read_out, stdout=subprocess.PIPE, stderr=errors)
        writing = subprocess.Popen(write_in, env=environment, stdin=subprocess.PIPE, stdout=errors, stderr=errors)
        with suppress(BrokenPipeError), reading, writing:  # psql ends at the first error, with its message
            assert reading.stdout is not None
            assert writing.stdin is not None
            writing.stdin.write(_EMPTY)
            shutil.copyfileobj(reading.stdout, writing.stdin)
            if reading.wait() == 0:
                writing.stdin.write(b"commit;\n")
        errors.seek(0)
        _refuse_failed("pg_restore", reading.returncode or writing.returncode, errors.read())


def _tool(url: str, name: str, *words: str) -> None:
    command, environment = _command(url, name, *words)
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    _refuse_failed(name, done.returncode, done.stderr)


def _refuse_failed(name: str, code: int, errors: str) -> None:
    if code != 0:
        lines = errors.strip().splitlines() or [f"it ended with exit code {code}"]
        first = next((line for line in lines if "error:" in line.lower()), lines[-1])
        raise BackupError(f"{name} failed: {first}")


def _command(url: str, name: str, *words: str) -> tuple[list[str], Mapping[str, str]]:
    """A command with the address for `{}`, and its environment: the password is not on the command line."""
    path = shutil.which(name)
    if path is None:
        raise BackupError(f"{name} was not found: install PostgreSQL's client programs (on Debian: postgresql-client)")
    address = sa.make_url(url).set(drivername="postgresql")
    password = address.password
    target = address.set(password=None).render_as_string()
    environment = os.environ | ({"PGPASSWORD": str(password)} if password else {})
    return [path, *(word.replace("{}", target) for word in words)], environment


def _file_of(url: str) -> Path:
    return Path(str(sa.make_url(url).database)).absolute()


def _on_disk(path: Path) -> None:
    file = os.open(path, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
