"""Reports of runs that have ended, kept while nothing that they state changes.

A report takes the time of a hundred other answers. What is kept is found by the content of all that it states, read
again for every request: a changed result, sign-off, name or catalogue is another report.
"""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from backend.catalog.service import published_digest
from backend.db.tables import Run, RunBaseline, RunLabel, Stage
from backend.runs.question import asked_again
from backend.runs.violations import sentence_of
from backend.signoffs import service as signoffs
from campaigns.runs import ENDED

MOST = 32
"""Number of kept reports; each has the size of its typeface and figures, a third of a megabyte."""


def key(reader: sa.Connection, run_id: int, pages: Path) -> str | None:
    """The digest of all that the report of a run states; None while the run can still change, or if there is none.

    The digest of the sign-offs is that of the results as they are stored now, computed again.
    """
    state = reader.scalar(sa.select(Run.state).where(Run.id == run_id, Run.purged.is_(None)))
    if state not in ENDED:
        return None
    parts = [
        signoffs.listed(reader, run_id).model_dump_json(),
        _rows(reader, Run, Run.id == run_id, Run.id),
        _rows(reader, Stage, Stage.run_id == run_id, Stage.position, without=("result",)),
        _rows(reader, RunBaseline, RunBaseline.run_id == run_id, RunBaseline.run_id),
        _rows(reader, RunLabel, RunLabel.run_id == run_id, RunLabel.key),
        published_digest(reader),
        asked_again(reader, run_id),
        sentence_of(reader, run_id),
        str(pages),
    ]
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _rows(reader: sa.Connection, table: Any, of: Any, order: Any, without: tuple[str, ...] = ()) -> list[Any]:
    columns = [column for column in table.__table__.columns if column.name not in without]
    return [tuple(row) for row in reader.execute(sa.select(*columns).where(of).order_by(order))]


@dataclass(frozen=True)
class Page:
    """A report and the content security policy for its style element."""

    html: str
    policy: str
    file: str


@dataclass
class Kept:
    """The reports that were asked for last, of all threads: one of a run, found by its key, in UTF-8, which takes half
    of the space."""

    _found: OrderedDict[int, tuple[str, bytes, Page]] = field(default_factory=OrderedDict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def get(self, run_id: int, known: str | None) -> Page | None:
        """The stored page, or None if the report must be written."""
        with self._lock:
            kept, text, page = self._found.get(run_id, ("", b"", None))
            if page is None or kept != known:
                return None
            self._found.move_to_end(run_id)
        return replace(page, html=text.decode())

    def put(self, run_id: int, known: str | None, page: Page) -> None:
        if known is None:
            return
        with self._lock:
            self._found[run_id] = known, page.html.encode(), replace(page, html="")
            self._found.move_to_end(run_id)
            while len(self._found) > MOST:
                self._found.popitem(last=False)
