"""`clearance serve` as a process, and a client of it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import sqlalchemy as sa

from backend.db.engine import connect, default_url, read
from backend.db.queue import submit
from backend.db.tables import Run
from tests.faults.long import case
from tests.faults.processes import CLEARANCE, Started, command_of, started, until


class Service(Started):
    """A running `clearance serve`."""

    data: Path
    began: float
    """When it was started, by the monotonic clock."""

    def healthy(self) -> bool:
        return get(self.address() + "/api/v1/health") == 200

    def part(self, words: str) -> int:
        """The process with that command line; 0 if there is none."""
        return next((pid for pid in self.family() if words in command_of(pid)), 0)


@contextmanager
def serving(folder: Path, **environment: str) -> Iterator[Service]:
    data, began = folder / "data", time.monotonic()
    with started([*CLEARANCE, "serve", "--data", str(data), "--port", "0"], folder, "serve", **environment) as running:
        running.__class__ = Service
        assert isinstance(running, Service)
        running.data, running.began = data, began
        until(lambda: running.link() or running.process.poll() is not None, "ready", 120)
        assert running.process.poll() is None, running.text()
        yield running


def get(url: str) -> int:
    """The status of the response; 0 if there is none."""
    try:
        return httpx.get(url, timeout=10, trust_env=False, verify=False).status_code
    except httpx.TransportError:
        return 0


def long_run(data: Path) -> tuple[sa.Engine, int]:
    """A run of the service that is well under way: the database of the folder, and its number."""
    engine = connect(default_url(data))
    with engine.begin() as connection:
        run_id = submit(connection, case(), name="long", tags=[], owner="", planned=0)
    until(lambda: state(engine, run_id).evaluations > 2000, "well under way")
    return engine, run_id


def state(engine: sa.Engine, run_id: int) -> Any:
    """The row of a run."""
    with read(engine) as connection:
        return connection.execute(sa.select(Run).where(Run.id == run_id)).one()
