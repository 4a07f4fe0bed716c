"""Whether the database can be used at a start, or is worth waiting for: a PostgreSQL server that is away may come."""

from __future__ import annotations

from backend.db.engine import migrate
from backend.db.outages import DatabaseOutage

PAUSE = 1.0
"""Between two attempts [s]."""


def awaited(url: str) -> DatabaseOutage | None:
    """Migrate the database; the outage if its server is away. Whatever waiting does not mend is raised."""
    try:
        migrate(url)
    except DatabaseOutage as error:
        if url.startswith("sqlite") or error.kind != "database-away":
            raise
        return error
    return None


def sentence(outage: DatabaseOutage) -> str:
    """What a log says meanwhile; the driver's words tell a server that is down from a wrong password."""
    return f"waiting for the database: {outage} ({' '.join(str(outage.orig).split())})"
