"""Opens the database: SQLite in WAL mode or PostgreSQL; `engine.begin()` writes, `read(engine)` reads.

Source: SQLite, "Write-Ahead Logging" and "Transaction" (sqlite.org/lang_transaction.html): a deferred transaction that
turns into a writer can fail at once whatever the timeout, an immediate one waits its turn.
"""

from __future__ import annotations

import errno
import functools
import json
import os
import sqlite3
import time
from collections.abc import Callable, Hashable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import sqlalchemy as sa
from sqlalchemy.dialects import sqlite

from backend.db import beside, outages, revision
from backend.db.private import create_private

if TYPE_CHECKING:
    from sqlalchemy.dialects import postgresql

Result = TypeVar("Result")
Value = TypeVar("Value", int, str)

BUSY_TIMEOUT = 30.0
"""How long an SQLite writer waits for another writer [s]."""

CHUNK = 500
"""Values that are read in one statement."""

SERVER_LIMITS = {
    "connect_timeout": 5,
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    "tcp_user_timeout": 20_000,
}
"""After which a PostgreSQL server that is silent counts as away [s, the last one ms]; those of the address win."""

CLIENT_LIMITS = {
    "tcp_keepalives_idle": 10,
    "tcp_keepalives_interval": 5,
    "tcp_keepalives_count": 3,
    "tcp_user_timeout": 20_000,
    "idle_in_transaction_session_timeout": 60_000,
}
"""After which the server gives up a client that is silent [s, the last two ms]. By the system's own, two hours and
never, a machine that is cut off and a process that is stopped within a transaction keep its locks, and no worker can
take its run."""


class NewerSchemaError(ValueError):
    """A newer version of Clearance has migrated the database."""

    def __init__(self, stored: str) -> None:
        super().__init__(
            f"the database has schema {stored}, and this version of Clearance knows {revision.newest()}: install the "
            "newer version again, or restore a backup that was made before the update"
        )


_json = functools.partial(json.dumps, allow_nan=False)
_READ = "clearance_read"
_COMPUTED = "clearance_computed"
"""What `once` has computed from the snapshot of a reader."""
_MIGRATION_LOCK = 0x636C6561
"""Key of the PostgreSQL advisory lock that serialises migrations."""


def connect(url: str, busy_timeout: float | None = None, create: bool = True) -> sa.Engine:
    """An engine for `sqlite:///path` or `postgresql://...`; create: whether a missing SQLite file is made now.

    busy_timeout: how long a writer waits for a lock [s]; on PostgreSQL it is set only if given. Every SQLite
    transaction is BEGIN IMMEDIATE, except those of `read`. Raises `ValueError` for any other database, and where
    its driver is not installed. What is wrong with the database itself is raised as `outages.DatabaseOutage`; a file
    that is deleted is not made again.
    """
    try:
        parsed = sa.make_url(url)
    except sa.exc.ArgumentError:
        raise ValueError("invalid database address: give sqlite:///FILE or postgresql://...") from None
    backend = parsed.get_backend_name()
    if backend == "sqlite":
        return _sqlite(parsed, BUSY_TIMEOUT if busy_timeout is None else busy_timeout, create)
    if backend in ("postgresql", "postgres"):
        limits: dict[str, int | str] = {name: n for name, n in SERVER_LIMITS.items() if name not in parsed.query}
        if busy_timeout is not None:
            limits["options"] = f"-c lock_timeout={busy_timeout * 1000:.0f}"
        address = parsed.set(drivername="postgresql+psycopg")
        try:
            engine = sa.create_engine(address, pool_pre_ping=True, json_serializer=_json, connect_args=limits)
        except ModuleNotFoundError as missing:
            raise ValueError(
                f"PostgreSQL needs the package {missing.name}, which is not installed: pip install 'psycopg[binary]'"
            ) from None
        sa.event.listen(engine, "connect", _limited)
        return outages.watched(engine)
    raise ValueError(
        f"the database {parsed.render_as_string()!r} is not supported: give sqlite:///FILE or postgresql://..."
    )


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
    computed = {_COMPUTED: dict[Hashable, Any]()} if is_sqlite(engine) else {}
    with engine.connect() as connection:
        yield connection.execution_options(**{_READ: True}, **computed)


def one_snapshot(reader: sa.Connection) -> bool:
    """Whether all that a connection reads is of one snapshot. On PostgreSQL each statement has its own."""
    return _COMPUTED in reader.get_execution_options()


def once(reader: sa.Connection, key: Hashable, compute: Callable[[], Result]) -> Result:
    """What `compute` reads, computed once for one snapshot: several parts of an answer state the same.

    The result is shared: it must not be changed. Elsewhere, as within a write, it is computed at each call.
    """
    computed: dict[Hashable, Result] | None = reader.get_execution_options().get(_COMPUTED)
    if computed is None:
        return compute()
    if not reader.in_transaction():
        computed.clear()  # of a snapshot that has ended
    if key not in computed:
        computed[key] = compute()
    return computed[key]


def ask(engine: sa.Engine, question: Callable[[sa.Connection], Result]) -> Result:
    """What a function reads from one snapshot."""
    with read(engine) as reader:
        return question(reader)


def now(connection: sa.Connection) -> float:
    """The queue's clock [s since 1970]: on PostgreSQL the server's, so that machine clocks need not agree."""
    if is_sqlite(connection):
        return time.time()
    return float(connection.scalar(sa.text("select extract(epoch from clock_timestamp())")) or 0.0)


def clock(connection: sa.Connection) -> Any:
    """The clock in a statement that writes, which needs no earlier request to the server."""
    return time.time() if is_sqlite(connection) else sa.text("extract(epoch from clock_timestamp())")


def chunks(values: Iterable[Value]) -> Iterator[list[Value]]:
    """The values in order, as many at a time as one statement reads."""
    ordered = sorted(values)
    return (ordered[first : first + CHUNK] for first in range(0, len(ordered), CHUNK))


def write(engine: sa.Engine, work: Callable[[sa.Connection], Result], patience: float) -> Result:
    """Run one write transaction, retried for up to `patience` [s] while the database is locked or unreachable.

    If it is unknown whether a commit succeeded, `work` runs again: it must be idempotent or detect the repetition.
    """
    deadline, pause = time.monotonic() + patience, 0.05
    while True:
        try:
            with engine.begin() as connection:
                return work(connection)
        except sa.exc.OperationalError as error:
            if time.monotonic() + pause > deadline or getattr(error, "kind", "") == "damaged":
                raise
        time.sleep(pause)
        pause = min(2.0, 2 * pause)


@contextmanager
def connected(url: str) -> Iterator[sa.Engine]:
    """An engine whose connections are closed at the end of the block."""
    engine = connect(url)
    try:
        yield engine
    finally:
        engine.dispose()


@contextmanager
def migration_lock(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A write transaction that is exclusive among all processes that start at the same time."""
    with engine.begin() as connection:
        if not is_sqlite(connection):
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_MIGRATION_LOCK)))
        yield connection


def migrate(url: str) -> None:
    """Migrate the database to the newest schema; safe when several processes start at once.

    Raises `NewerSchemaError`, and `outages.DatabaseOutage` if the database cannot be used.
    """
    with connected(url) as engine:
        refuse_read_only(engine)
        if is_sqlite(engine):
            # A table is altered by copying and dropping it, which must not cascade; the pragma has no effect later.
            sa.event.listen(engine, "connect", lambda connection, _: connection.execute("PRAGMA foreign_keys=OFF"))
        with migration_lock(engine) as connection:
            stored = revision.stored(connection)
            if stored == revision.newest():
                return
            if stored is not None and stored not in revision.known():
                raise NewerSchemaError(stored)
            from backend.db.migrate import to_head  # only where it is needed: Alembic takes 0.2 s to load

            to_head(connection)


def refuse_read_only(engine: sa.Engine) -> None:
    """Raise `DatabaseOutage` for an SQLite file that is there and cannot be written.

    In WAL mode a write transaction begins even then, and fails later.
    """
    file = Path(str(engine.url.database))
    if (
        is_sqlite(engine)
        and file.exists()
        and not (os.access(file, os.W_OK) and os.access(file.absolute().parent, os.W_OK))
    ):
        error = PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(file))
        raise outages.DatabaseOutage("database-away", outages.READ_ONLY, error, False)


def _limited(connection: Any, _record: Any) -> None:
    """Not by `options` of the address, which poolers of connections refuse."""
    connection.autocommit = True
    connection.execute("; ".join(f"set {name} = {n}" for name, n in CLIENT_LIMITS.items()))
    connection.autocommit = False


def _sqlite(url: sa.URL, busy_timeout: float, create: bool) -> sa.Engine:
    if not url.database or url.database == ":memory:":
        raise ValueError(
            "an SQLite database must be a file, because several processes use it: give sqlite:///path/to/file"
        )
    file = Path(url.database).absolute()
    if create:
        create_private(file)
    engine = sa.create_engine(url, connect_args={"timeout": busy_timeout}, json_serializer=_json)

    @sa.event.listens_for(engine, "do_connect")
    def _opening(_dialect: Any, _record: Any, arguments: list[Any], options: Any) -> None:
        beside.refuse_deleted(file)
        arguments[:] = [file_uri(file, "rw")]  # a file that was deleted is not made again
        options["uri"] = True

    @sa.event.listens_for(engine, "connect")
    def _connected(connection: sqlite3.Connection, record: Any) -> None:
        connection.isolation_level = None  # otherwise the driver begins its own, deferred, transactions
        for pragma in (f"busy_timeout={busy_timeout * 1000:.0f}", "synchronous=NORMAL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}")
        _set_wal(connection)
        connection.execute("PRAGMA schema_version").fetchone()  # reads, which opens the files beside it
        beside.opened(record, file)

    sa.event.listen(engine, "close", beside.closing)

    @sa.event.listens_for(engine, "checkout")
    def _checked(_connection: Any, record: Any, _proxy: Any) -> None:
        if record.info["files"][0] != beside.inode(file):
            raise sa.exc.DisconnectionError(f"{file} was deleted or replaced")  # the pool opens what is there now

    @sa.event.listens_for(engine, "begin")
    def _begun(connection: sa.Connection) -> None:
        beside.refuse_deleted(file)  # not at the checkout, which would close the connection that may be the last one
        options = connection.get_execution_options()
        options.get(_COMPUTED, {}).clear()  # of a snapshot that has ended, whatever statement begins the next one
        connection.exec_driver_sql("BEGIN" if options.get(_READ, False) else "BEGIN IMMEDIATE")

    return outages.watched(engine)


def file_uri(file: Path, mode: str) -> str:
    """The URI of an SQLite file; mode: ro or rw, which do not create it."""
    return f"{file.absolute().as_uri()}?mode={mode}"


def _set_wal(connection: sqlite3.Connection) -> None:
    """Enable WAL, a property of the file; retried because this pragma can fail on a lock without the busy handler."""
    deadline = time.monotonic() + BUSY_TIMEOUT
    while True:
        try:
            if connection.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
                connection.execute("PRAGMA journal_mode=WAL")
            return
        except sqlite3.OperationalError as error:
            locked = error.sqlite_errorname.startswith(("SQLITE_BUSY", "SQLITE_LOCKED"))
            if not locked or time.monotonic() > deadline:
                raise
            time.sleep(0.01)
