"""Whether an installation can do its work now: the reasons why not, each a sentence that names no address or file."""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa

from backend.db import damage, revision, space, workers
from backend.db.engine import read, refuse_read_only
from backend.db.outages import DatabaseOutage
from campaigns import Problem

NO_WORKER = "no worker is alive, so that runs wait: start `clearance serve` or `clearance worker`"
NO_FOLDER = "the data folder is not there any more: put it back, or start the service again"


def reasons(engine: sa.Engine, data: Path, room: space.Room) -> list[Problem]:
    """Why no run can be done now; none if it can.

    The field is what is missing: `workers`, `space`, `folder`, `schema`, or a kind of `DatabaseOutage`.
    """
    found = []
    if not data.is_dir():
        found.append(Problem("folder", "", NO_FOLDER))
    if why := room.short():
        found.append(Problem("space", "", why))
    try:
        with read(engine) as connection:
            stored, newest = revision.stored(connection), revision.newest()
            if stored != newest:
                sentence = f"the database has schema {stored}, and this version of Clearance needs {newest}"
                found.append(Problem("schema", "", f"{sentence}: start the service again"))
            elif not workers.live(connection):
                found.append(Problem("workers", "", NO_WORKER))
        damage.refuse(engine)
        refuse_read_only(engine)
    except DatabaseOutage as error:
        found.append(Problem(error.kind, "", error.sentence))
    return found
