"""Numbers that clients store, such as R-0001: those that a restored database gives continue above those of the former.

PostgreSQL counts by sequences, and so does SQLite for drafts. For its other tables SQLite gives the number after the
highest one in the table; the number to continue above is in the settings of the service there.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Mapping
from typing import Any

import sqlalchemy as sa

from backend.db.engine import is_sqlite
from backend.db.tables import Draft, RequirementFile, Run, ServiceSetting, Signoff, Sweep

TABLES = tuple(table.__tablename__ for table in (Run, Sweep, Signoff, RequirementFile, Draft))
"""Tables with numbers that the API states. The audit trail is not among them: its rows are consecutive."""
_KEY = "numbers"
_LAST = "pg_sequence_last_value(pg_get_serial_sequence('{table}', 'id')::regclass)"


def following(writer: sa.Connection, table: type[Run | Sweep | Signoff | RequirementFile]) -> dict[str, int]:
    """The number of a new row as its column, if it has to be above those of a former database; else empty."""
    if not is_sqlite(writer):
        return {}
    stored = writer.scalar(sa.select(ServiceSetting.value).where(ServiceSetting.key == _KEY)) or [{}]
    last = int(stored[0].get(table.__tablename__, 0))
    highest = 0 if last == 0 else writer.scalar(sa.select(sa.func.max(table.id))) or 0
    return {"id": last + 1} if last > highest else {}


def of_file(connection: sqlite3.Connection) -> dict[str, int] | None:
    """The highest numbers that an SQLite database has given, by table; None if it cannot be read."""
    try:
        if connection.execute("pragma quick_check(1)").fetchone() != ("ok",):
            return None
        return _of_sqlite(lambda query: next(iter(connection.execute(query).fetchone() or [None])))
    except sqlite3.Error:
        return None


def of_server(engine: sa.Engine) -> dict[str, int] | None:
    """The highest numbers that a PostgreSQL database has given, by table; None if it cannot be read."""
    try:
        with engine.connect() as reader:
            return _of_server(reader)
    except sa.exc.DBAPIError:
        return None


def continue_above(writer: sa.Connection, highest: Mapping[str, int]) -> dict[str, int] | None:
    """Let a restored database, of any version, give numbers above these as well as its own; returns both, by table.

    None if an SQLite file is of a version without settings.
    """
    sqlite = is_sqlite(writer)
    own = _of_sqlite(lambda query: writer.exec_driver_sql(query).scalar()) if sqlite else _of_server(writer)
    if own is None:
        return None
    last = {table: max(number, highest.get(table, 0)) for table, number in own.items()}
    if not sqlite:
        for table, number in last.items():
            if number > own[table]:
                writer.exec_driver_sql(f"select setval(pg_get_serial_sequence('{table}', 'id'), {number})")
        return last
    if "service_settings" not in sa.inspect(writer).get_table_names():
        return None
    setting = ServiceSetting.__table__
    writer.execute(sa.delete(ServiceSetting).where(ServiceSetting.key == _KEY))
    writer.execute(sa.insert(setting).values(key=_KEY, value=[last]))  # type: ignore[arg-type]
    drafts = last.get(Draft.__tablename__, 0)
    writer.exec_driver_sql("delete from sqlite_sequence where name = 'drafts'")
    writer.exec_driver_sql("insert into sqlite_sequence (name, seq) values ('drafts', ?)", (drafts,))
    return last


def _of_sqlite(scalar: Callable[[str], Any]) -> dict[str, int] | None:
    def has(table: str) -> bool:
        return bool(scalar(f"select 1 from sqlite_master where type = 'table' and name = '{table}'"))

    setting = f"select value from service_settings where key = '{_KEY}'"
    before = json.loads((scalar(setting) if has("service_settings") else None) or "[{}]")[0]
    found = {
        table: max(before.get(table, 0), scalar(f"select max(id) from {table}") or 0) for table in filter(has, TABLES)
    }
    if Draft.__tablename__ in found:
        sequence = scalar("select seq from sqlite_sequence where name = 'drafts'") or 0
        found[Draft.__tablename__] = max(found[Draft.__tablename__], sequence)
    return found if Run.__tablename__ in found else None


def _of_server(reader: sa.Connection) -> dict[str, int] | None:
    there = set(sa.inspect(reader).get_table_names())
    queries = {t: f"select greatest((select max(id) from {t}), {_LAST.format(table=t)})" for t in TABLES if t in there}
    found = {table: int(reader.exec_driver_sql(query).scalar() or 0) for table, query in queries.items()}
    return found if Run.__tablename__ in found else None
