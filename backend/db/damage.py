"""Whether an SQLite file in which this process has met damage is whole again; it is read at most once a minute."""

from __future__ import annotations

import sqlite3
import time
from contextlib import closing
from pathlib import Path

import sqlalchemy as sa

from backend.db import outages
from backend.db.engine import file_uri, is_sqlite
from backend.db.outages import DatabaseOutage

PERIOD = 60.0
"""Between two readings of the whole file, which takes about a second per gigabyte [s]."""

_read: dict[str, float] = {}
"""When each file was read last [s of the monotonic clock]."""


def damage(file: Path) -> str:
    """What is wrong with an SQLite file, in SQLite's words; empty if it is whole."""
    try:
        with closing(sqlite3.connect(file_uri(file, "ro"), uri=True, timeout=30.0)) as connection:
            found = [str(row[0]) for row in connection.execute("PRAGMA quick_check(3)")]
    except sqlite3.DatabaseError as error:
        return str(error)
    return "" if found == ["ok"] else "; ".join(" ".join(one.split()) for one in found)


def refuse(engine: sa.Engine) -> None:
    """Raise `DatabaseOutage` while the database is damaged, as far as this process has met it."""
    if not outages.met(engine, "damaged"):
        return
    file, at = str(engine.url.database), time.monotonic()
    if is_sqlite(engine) and at - _read.get(file, -PERIOD) >= PERIOD:
        _read[file] = at
        if not damage(Path(file)):
            outages.over(engine, "damaged")
            return
    raise DatabaseOutage("damaged", outages.SENTENCES["damaged"], sqlite3.DatabaseError("damage was met"), False)
