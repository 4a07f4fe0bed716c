"""What is wrong with the database itself, as one error with a sentence: away, gone, damaged, without space, busy.

`watched` has every engine raise it in the place of the driver's errors. Its text never contains a statement or a
parameter, so that it may be stored and shown. What a statement alone has caused stays the error that it is.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from pathlib import Path
from typing import Any, Literal

import sqlalchemy as sa

from campaigns.claims.legible import legible

Kind = Literal["database-away", "database-gone", "damaged", "no-space", "busy"]

SENTENCES: dict[Kind, str] = {
    "database-away": "the database cannot be reached: its server is down or its file cannot be opened; nothing was "
    "changed, and work goes on as soon as it answers",
    "database-gone": "the database is not there any more: its file was deleted or has no tables; an administrator must "
    "put it back, or restore a backup and start the service again",
    "damaged": "the database is damaged: an administrator must stop the service and workers, keep a copy of the file, "
    "and restore the newest backup",
    "no-space": "the disk of the database is full; nothing was changed: an administrator must free space",
    "busy": "the database is busy: try again in a few seconds",
}
READ_ONLY = (
    "the database cannot be written: its file or folder is read-only; nothing was changed: an administrator must make "
    "it writable"
)

_SQLITE: dict[str, Kind] = {
    "SQLITE_FULL": "no-space",
    "SQLITE_BUSY": "busy",
    "SQLITE_LOCKED": "busy",
    "SQLITE_PROTOCOL": "busy",
    "SQLITE_CORRUPT": "damaged",
    "SQLITE_NOTADB": "damaged",
    "SQLITE_CANTOPEN": "database-away",
    "SQLITE_IOERR": "database-away",
    "SQLITE_READONLY": "database-away",
}
"""By the name of the primary result code."""
_POSTGRESQL: dict[str, Kind] = {
    "08": "database-away",
    "57P01": "database-away",
    "57P02": "database-away",
    "57P03": "database-away",
    "58": "database-away",
    "25006": "database-away",  # a standby, which only reads
    "25P03": "database-away",  # it stood still within a transaction, which the server has ended
    "53100": "no-space",
    "53": "busy",
    "55P03": "busy",
    "40": "busy",
    "XX001": "damaged",
    "XX002": "damaged",
    "42P01": "database-gone",
    "3D000": "database-gone",
}
"""By the beginning of the SQLSTATE; the longest one counts."""

_met: set[tuple[str, Kind]] = set()
"""The URLs of databases in which this process has met damage, or a write of it has failed for want of space."""


class DatabaseOutage(sa.exc.OperationalError):
    """The database itself cannot be used; `kind` and `sentence` say why."""

    def __init__(self, kind: Kind, sentence: str, orig: BaseException, invalidated: bool) -> None:
        super().__init__(None, None, orig, connection_invalidated=invalidated)
        self.kind, self.sentence = kind, sentence

    def __str__(self) -> str:
        return self.sentence


def watched(engine: sa.Engine) -> sa.Engine:
    """Have the engine raise `DatabaseOutage`, and drop connections that cannot be used any more."""
    url = engine.url.render_as_string(hide_password=False)

    @sa.event.listens_for(engine, "handle_error")
    def _converted(context: Any) -> BaseException | None:
        kind = _kind(context)
        if kind is None:
            return None
        if kind not in ("busy", "no-space"):
            # A handle that was opened read-only, or before the file was replaced, stays so.
            context.is_disconnect = True
            _rolled_back(context.connection)
        if kind in ("damaged", "no-space"):
            _met.add((url, kind))
        if context.is_pre_ping:
            return None
        orig = context.original_exception
        sentence = READ_ONLY if _read_only(orig, engine) else SENTENCES[kind]
        return DatabaseOutage(kind, sentence, orig, context.is_disconnect)

    return engine


def _rolled_back(connection: sa.Connection | None) -> None:
    """SQLite closes a connection with a pending statement later, and until then it would hold the write lock."""
    if connection is None or connection.dialect.name != "sqlite" or connection.invalidated:
        return
    with contextlib.suppress(sa.exc.SQLAlchemyError, sqlite3.Error):
        raw = connection.connection.driver_connection
        if raw is not None:
            raw.rollback()


LONGEST = 4000
"""Maximum stored length of the reason why an attempt failed [characters]."""


def storable(text: str) -> str:
    """A reason that others have worded, as every database stores it: not too long, and without null characters and
    unpaired surrogates."""
    return legible(text[:LONGEST], "\n\t")


def worded(error: BaseException) -> str:
    """An error as it may be stored with a run and shown: without the statement, its parameters and rows."""
    if isinstance(error, DatabaseOutage) or not isinstance(error, sa.exc.SQLAlchemyError):
        return " ".join(str(error).split())
    cause = getattr(error, "orig", None)
    if cause is None:
        return " ".join(str(error).partition("[SQL")[0].split())
    # The first line: PostgreSQL's next ones hold rows and the statement.
    return " ".join((str(cause).splitlines() or [""])[0].split())


def met(engine: sa.Engine, kind: Kind) -> bool:
    """Whether this process has met damage in the database, or want of space at a write, since it was `over`."""
    return (engine.url.render_as_string(hide_password=False), kind) in _met


def over(engine: sa.Engine, kind: Kind) -> None:
    """Note that a check has found the database whole, or that a write has succeeded."""
    _met.discard((engine.url.render_as_string(hide_password=False), kind))


def _kind(context: Any) -> Kind | None:
    error, dialect = context.original_exception, context.dialect
    if not isinstance(error, dialect.loaded_dbapi.Error):
        return None
    if dialect.name == "sqlite":
        return _sqlite_kind(error, context.engine)
    state = getattr(error, "sqlstate", None) or ""
    for length in (5, 2):
        if found := _POSTGRESQL.get(state[:length]):
            return found
    away = context.is_disconnect or (not state and isinstance(error, dialect.loaded_dbapi.OperationalError))
    return "database-away" if away else None


def _sqlite_kind(error: Any, engine: sa.Engine | None) -> Kind | None:
    name = getattr(error, "sqlite_errorname", None) or ""
    found = next((kind for code, kind in _SQLITE.items() if name == code or name.startswith(code + "_")), None)
    if found == "database-away" and engine is not None and not Path(str(engine.url.database)).exists():
        return "database-gone"
    if found is None and name == "SQLITE_ERROR" and str(error).startswith("no such table"):
        return "database-gone"
    return found


def _read_only(error: Any, engine: sa.Engine) -> bool:
    name = getattr(error, "sqlite_errorname", None) or ""
    if getattr(error, "sqlstate", None) == "25006" or name.startswith("SQLITE_READONLY"):
        return True
    file = Path(str(engine.url.database))
    return name.startswith("SQLITE_CANTOPEN") and file.exists() and not os.access(file.parent, os.W_OK)
