"""Opens the database: SQLite in WAL mode or PostgreSQL; `engine.begin()` writes, `read(engine)` reads.

Source: SQLite, "Write-Ahead Logging" and "Transaction" (sqlite.org/lang_transaction.html): a deferred transaction that
turns into a writer can fail at once whatever the timeout, an immediate one waits its turn.
"""

from __future__ import annotations

import functools
import json
import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import sqlalchemy as sa
from sqlalchemy.dialects import sqlite

from backend.db import revision
from backend.db.private import create_private

if TYPE_CHECKING:
    from sqlalchemy.dialects import postgresql

Result = TypeVar("Result")

BUSY_TIMEOUT = 30.0
"""How long an SQLite writer waits for another writer [s]."""

_json = functools.partial(json.dumps, allow_nan=False)
_READ = "clearance_read"
_MIGRATION_LOCK = 0x636C6561
"""Key of the PostgreSQL advisory lock that serialises migrations."""


def connect(url: str, busy_timeout: float | None = None) -> sa.Engine:
    """An engine for `sqlite:///path` or `postgresql://...`; creates the folder of an SQLite file if it is missing.

    busy_timeout: how long a writer waits for a lock [s]; on PostgreSQL it is set only if given. Every SQLite
    transaction is BEGIN IMMEDIATE, except those of `read`. Raises `ValueError` for any other database.
    """
    try:
        parsed = sa.make_url(url)
    except sa.exc.ArgumentError:
        raise ValueError("invalid database address: give sqlite:///FILE or postgresql://...") from None
    backend = parsed.get_backend_name()
    if backend == "sqlite":
        return _sqlite(parsed, BUSY_TIMEOUT if busy_timeout is None else busy_timeout)
    if backend in ("postgresql", "postgres"):
        limits = "" if busy_timeout is None else f"-c lock_timeout={busy_timeout * 1000:.0f}"
        return sa.create_engine(
            parsed.set(drivername="postgresql+psycopg"),
            pool_pre_ping=True,
            json_serializer=_json,
            connect_args={"options": limits} if limits else {},
        )
    address = parsed.render_as_string()
    raise ValueError(f"the database {address!r} is not supported: give sqlite:///FILE or postgresql://...")


def default_url(data: Path) -> str:
    return f"sqlite:///{data.absolute() / 'clearance.sqlite3'}"


def is_sqlite(bind: sa.Engine | sa.Connection) -> bool:
    return bind.dialect.name == "sqlite"


def insert(connection: sa.Connection, table: Any) -> sqlite.Insert | postgresql.Insert:
    """The dialect's insert, which has `on_conflict_do_nothing` and `on_conflict_do_update`."""
    if is_sqlite(connection):
        return sqlite.insert(table)
    from sqlalchemy.dialects import postgresql  # imported late: a twentieth of the time in which a process starts

    return postgresql.insert(table)


@contextmanager
def read(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A read-only connection with one snapshot; on SQLite it neither waits for writers nor blocks them."""
    with engine.connect() as connection:
        yield connection.execution_options(**{_READ: True})


def now(connection: sa.Connection) -> float:
    """The queue's clock [s since 1970]: on PostgreSQL the server's, so that machine clocks need not agree."""
    if is_sqlite(connection):
        return time.time()
    return float(connection.scalar(sa.text("select extract(epoch from clock_timestamp())")) or 0.0)


def write(engine: sa.Engine, work: Callable[[sa.Connection], Result], patience: float) -> Result:
    """Run one write transaction, retried for up to `patience` [s] while the database is locked or unreachable.

    If it is unknown whether a commit succeeded, `work` runs again: it must be idempotent or detect the repetition.
    """
    deadline, pause = time.monotonic() + patience, 0.05
    while True:
        try:
            with engine.begin() as connection:
                return work(connection)
        except sa.exc.OperationalError:
            if time.monotonic() + pause > deadline:
                raise
        time.sleep(pause)
        pause = min(2.0, 2 * pause)


@contextmanager
def migration_lock(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A write transaction that is exclusive among all processes that start at the same time."""
    with engine.begin() as connection:
        if not is_sqlite(connection):
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_MIGRATION_LOCK)))
        yield connection


def migrate(url: str) -> None:
    """Migrate the database to the newest schema; safe when several processes start at once."""
    engine = connect(url)
    if is_sqlite(engine):
        # A table is altered by copying and dropping it, which must not cascade; the pragma has no effect later.
        sa.event.listen(engine, "connect", lambda connection, _: connection.execute("PRAGMA foreign_keys=OFF"))
    try:
        with migration_lock(engine) as connection:
            if revision.stored(connection) == revision.newest():
                return
            from backend.db.migrate import to_head  # only where it is needed: Alembic takes 0.2 s to load

            to_head(connection)
    finally:
        engine.dispose()


def _sqlite(url: sa.URL, busy_timeout: float) -> sa.Engine:
    if not url.database or url.database == ":memory:":
        raise ValueError(
            "an SQLite database must be a file, because several processes use it: give sqlite:///path/to/file"
        )
    create_private(Path(url.database).absolute())
    engine = sa.create_engine(url, connect_args={"timeout": busy_timeout}, json_serializer=_json)

    @sa.event.listens_for(engine, "connect")
    def _connected(connection: sqlite3.Connection, _record: Any) -> None:
        connection.isolation_level = None  # otherwise the driver begins its own, deferred, transactions
        for pragma in (f"busy_timeout={busy_timeout * 1000:.0f}", "synchronous=NORMAL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}")
        _set_wal(connection)

    @sa.event.listens_for(engine, "begin")
    def _begun(connection: sa.Connection) -> None:
        reads = connection.get_execution_options().get(_READ, False)
        connection.exec_driver_sql("BEGIN" if reads else "BEGIN IMMEDIATE")

    return engine


def _set_wal(connection: sqlite3.Connection) -> None:
    """Enable WAL, a property of the file; retried because this pragma can fail on a lock without the busy handler."""
    deadline = time.monotonic() + BUSY_TIMEOUT
    while True:
        try:
            if connection.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
                connection.execute("PRAGMA journal_mode=WAL")
            return
        except sqlite3.OperationalError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.01)
