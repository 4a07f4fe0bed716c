"""The history of a run, from the audit trail."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import audit
from backend.db.tables import Audit, Run
from backend.http.errors import not_found
from backend.runs.schemas import HistoryEntry
from campaigns.runs import run_name

MOST = 500


def history(reader: sa.Connection, run_id: int) -> list[HistoryEntry]:
    """At most `MOST` entries, newest first, also of a purged run; 404 if there is no such run."""
    if reader.scalar(sa.select(Run.id).where(Run.id == run_id)) is None:
        raise not_found("run", run_name(run_id))
    of = sa.select(Audit.at, Audit.user, audit.ACCOUNT, Audit.via, Audit.action, Audit.detail)
    rows = reader.execute(of.where(Audit.subject == run_name(run_id)).order_by(Audit.id.desc()).limit(MOST))
    return [HistoryEntry.model_validate(dict(row._mapping)) for row in rows]
