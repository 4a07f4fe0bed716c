"""What is installed now: what is published, as far as a live worker stands behind it. Read `installation`.

What no worker has compared its files with lately may have been edited since, and counts as changed.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db import workers
from backend.db.engine import once
from campaigns import Catalogue

NO_CODE = "no worker has published the code to compare it with"


def no_worker(since: float) -> str:
    return (
        f"no worker has been alive since {_date(since)}: the code cannot be compared with what is installed until a "
        "worker starts"
    )


def no_report(since: float) -> str:
    return (
        f"the live workers have not reported what they have installed since {_date(since)}: the code cannot be "
        "compared with it until one does"
    )


def no_simulator(name: str) -> str:
    return f"no live worker has {name}: a change of it cannot be excluded until one starts that has it"


def _date(at: float) -> str:
    return f"{datetime.fromtimestamp(at, UTC):%Y-%m-%d %H:%M} UTC"


@dataclass(frozen=True)
class Installation:
    """catalogue: with the digests of those simulators only that a live worker has; None if nothing can be compared;
    reason: then why, a clause; absent: the names of the other simulators."""

    catalogue: Catalogue | None
    reason: str = ""
    absent: frozenset[str] = frozenset()


def installation(reader: sa.Connection) -> Installation:
    """What a run of now would be of, as far as it is known."""
    return once(reader, "installation", lambda: _installed(reader))


def _installed(reader: sa.Connection) -> Installation:
    catalogue, report = published(reader), workers.reported(reader)
    if catalogue is None or catalogue.code is None or report is None:
        return Installation(None, NO_CODE)
    if not report.current:
        return Installation(None, no_report(report.at) if report.alive else no_worker(report.seen))
    names = {entry.name for entry in catalogue.simulators if not report.has(entry)}
    absent = frozenset(names & catalogue.digests.keys())
    if not absent:
        return Installation(catalogue)
    digests = {name: digest for name, digest in catalogue.digests.items() if name not in absent}
    return Installation(catalogue.model_copy(update={"digests": digests}), absent=absent)
