"""The stored rows of a run as an SQLite database, which `clearance audit` and `clearance replay` read like a service's.

It has what they need and no more: no owner, no notes, no other run.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from backend.db import revision, tables
from backend.db.engine import read
from backend.db.tables import Base, CampaignRow, CatalogueSnapshot, CodeVersion, Run
from backend.exports.format import Format, words
from backend.http.errors import no_temporary_file

PRIVATE = {"owner", "token", "worker", "notes", "removed_by", "removed_reason", "purged_by"}
"""Columns of the run that are left out: who had it run, and what was written on it."""
ROWS: tuple[Any, ...] = (tables.Stage, tables.EvaluationChunk, tables.Finding, tables.Trace)
"""Tables of rows that belong to one run."""
TABLES: tuple[Any, ...] = (CampaignRow, CatalogueSnapshot, CodeVersion, Run, *ROWS)
PIECE = 2**20
"""How much is sent at a time [bytes]."""


def record(engine: sa.Engine, run_id: int) -> Iterator[bytes]:
    """The database in pieces; it is a temporary file until all of it is sent. Raises 503 if it cannot be written."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="clearance-record-", ignore_cleanup_errors=True)
        file = Path(folder.name) / "record.sqlite3"
        target = _target(file)
        Base.metadata.create_all(target, tables=[table.__table__ for table in TABLES])
        with read(engine) as reader, target.begin() as writer:
            _copy(reader, writer, run_id)
    except (OSError, Unwritten) as error:
        raise no_temporary_file(error) from None
    return _sent(folder, file)


class Unwritten(Exception):
    """The file cannot be written."""


def _target(file: Path) -> sa.Engine:
    """The file as a database, whose errors are its own and none of the service's database."""
    target = sa.create_engine(f"sqlite:///{file}", poolclass=sa.NullPool)

    @sa.event.listens_for(target, "handle_error")
    def _own(context: Any) -> BaseException:
        return Unwritten(str(context.original_exception))

    return target


def _sent(folder: tempfile.TemporaryDirectory[str], file: Path) -> Iterator[bytes]:
    with folder, file.open("rb") as content:
        while piece := content.read(PIECE):
            yield piece


def _copy(reader: sa.Connection, writer: sa.Connection, run_id: int) -> None:
    """The rows of the run, and what they refer to; each is read only when it is written."""
    run = reader.execute(sa.select(Run.campaign_digest, Run.snapshot, Run.flown).where(Run.id == run_id)).one()
    of = dict[Any, Any]((table, table.run_id == run_id) for table in ROWS)
    of |= {
        CampaignRow: CampaignRow.digest == run.campaign_digest,
        CatalogueSnapshot: CatalogueSnapshot.digest == run.snapshot,
        CodeVersion: CodeVersion.digest == (run.flown or {}).get("code"),
        Run: Run.id == run_id,
    }
    for table, condition in of.items():
        columns = [c for c in table.__table__.columns if table is not Run or c.name not in PRIVATE]
        rows = reader.execute(sa.select(*columns).where(condition).execution_options(yield_per=1))
        for row in rows.mappings():
            writer.execute(sa.insert(table).values(dict(row)))
    writer.execute(sa.text("CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL)"))
    writer.execute(sa.text("INSERT INTO alembic_version VALUES (:known)"), {"known": revision.newest()})


export = Format(
    file="record.sqlite3",
    order=1.5,
    media_type="application/vnd.sqlite3",
    words=words("Record, SQLite", "The stored rows, from which clearance audit and clearance replay work elsewhere"),
    streamed=record,
)
