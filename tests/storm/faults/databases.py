"""What hurts the database under a run: locks, cut connections, a full disk, a server that stops."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import sqlalchemy as sa

from tests.faults import postgres
from tests.faults.processes import Started, kill
from tests.storm.faults.base import BEGUN, MIDDLE, Fault, Hurt
from tests.storm.site import Site

AWAY = 4.0
"""How long the database is away [s]: twice the lease."""


def locked(site: Site, worker: Started) -> None:
    """Another program holds the write lock."""
    with site.engine.begin() as connection:
        if site.engine.dialect.name == "postgresql":
            connection.execute(sa.text("lock table runs in access exclusive mode"))
        time.sleep(AWAY)


def connections(site: Site, worker: Started) -> None:
    """The server ends all connections; SQLite has none, its file is moved away and back while the worker is stopped."""
    if site.engine.dialect.name == "postgresql":
        with site.engine.begin() as connection:
            ended = "select pg_terminate_backend(pid) from pg_stat_activity where pid <> pg_backend_pid()"
            connection.execute(sa.text(ended + " and datname = current_database()"))
        return
    kill(*worker.family(), number=signal.SIGSTOP)
    file = Path(str(site.engine.url.database))
    site.engine.dispose()
    file.rename(file.with_suffix(".away"))
    file.with_suffix(".away").rename(file)
    kill(*worker.family(), number=signal.SIGCONT)


def stopped(server: postgres.Server, times: int = 1) -> Hurt:
    """The server ends as by a crash, and is there again."""

    def stop(site: Site, worker: Started) -> None:
        for _ in range(times):
            site.engine.dispose()
            server.stop()
            time.sleep(AWAY)
            server.start()

    return stop


FAULTS = {"database locked": Fault(locked), "connections cut": Fault(connections)}


def of_server(server: postgres.Server) -> dict[str, Fault]:
    """Those that only a server can have."""
    return {
        "server stopped at once": Fault(stopped(server)),
        "server stopped at once, before the first stage": Fault(stopped(server), BEGUN),
        "server stopped at once, twice": Fault(stopped(server, 2)),
        "server stopped at once, while slots fly": Fault(stopped(server), MIDDLE, "slots"),
    }
