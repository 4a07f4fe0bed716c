"""The workers as they last gave a sign, and the catalogue that the newest of them published.

Start reading at `publish` and `beat`.
"""

from __future__ import annotations

import os
import socket

import sqlalchemy as sa

from backend.db import codes
from backend.db.engine import insert, now
from backend.db.tables import CatalogueDocument, Worker
from campaigns.catalogue import Catalogue
from campaigns.flown import Code

FORGOTTEN = 24 * 3600.0
"""A worker silent for longer than this is no longer listed [s]."""


def publish(connection: sa.Connection, catalogue: Catalogue, code: Code | None = None) -> None:
    """Make the catalogue the one that campaigns are held against, and the code the one that is installed."""
    values = {"document": catalogue.model_dump(mode="json"), "published": now(connection)}
    values["code"] = None if code is None else code.digest
    if code is not None:
        codes.keep(connection, code)
    row = insert(connection, CatalogueDocument).values(id=1, **values)
    connection.execute(row.on_conflict_do_update(index_elements=["id"], set_=values))


def published(connection: sa.Connection) -> float | None:
    """When the catalogue was last published [s since 1970]; None before there is one."""
    return connection.scalar(sa.select(CatalogueDocument.published))


def arrive(connection: sa.Connection, name: str) -> None:
    """A worker has started under this name."""
    at = now(connection)
    gone = sa.or_(Worker.name == name, Worker.beat < at - FORGOTTEN)
    connection.execute(sa.delete(Worker).where(gone))
    values = {"name": name, "host": socket.gethostname()[:120], "pid": os.getpid(), "started": at, "beat": at}
    connection.execute(sa.insert(Worker).values(**values))


def beat(connection: sa.Connection, name: str, run_id: int | None) -> None:
    """The worker is alive, and works on this run."""
    connection.execute(sa.update(Worker).where(Worker.name == name).values(beat=now(connection), run_id=run_id))


def leave(connection: sa.Connection, name: str) -> None:
    """The worker has ended in good order."""
    connection.execute(sa.delete(Worker).where(Worker.name == name))


def alive(connection: sa.Connection, host: str, within: float = 60.0) -> bool:
    """Whether a worker on that machine gave a sign in the last `within` [s]."""
    found = sa.select(Worker.name).where(Worker.host == host[:120], Worker.beat > now(connection) - within)
    return connection.scalar(found.limit(1)) is not None
