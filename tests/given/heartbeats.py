"""Workers that are rows of the database, and count as alive for as long as a test takes."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import Worker
from backend.db.workers import SEEN


@contextmanager
def beating(engine: sa.Engine) -> Iterator[None]:
    """All workers of the database send heartbeats: one that is far ahead would not count."""
    ended = threading.Event()

    def beat() -> None:
        while not ended.wait(SEEN / 4):
            with engine.begin() as connection:
                connection.execute(sa.update(Worker).values(beat=now(connection)))

    thread = threading.Thread(target=beat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
