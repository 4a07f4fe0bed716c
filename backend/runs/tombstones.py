"""Tombstones of purged runs: number, name, digests, and who removed them, when and why.

Source: RFC 9110, 15.5.11, 410 Gone.
"""

from __future__ import annotations

import datetime
from typing import Any

import sqlalchemy as sa

from backend.db.tables import Run
from backend.http.errors import RefusedError
from campaigns.runs import run_name

_KEPT = (
    "id", "name", "campaign_digest", "removed", "removed_by", "removed_reason", "purged", "purged_by", "purged_digest",
)  # fmt: skip


def refuse_purged(reader: sa.Connection, run_id: int) -> None:
    """Raise 410 if the run was purged, with its remaining data; do nothing if it was not, or does not exist."""
    columns = [getattr(Run, name) for name in _KEPT]
    row = reader.execute(sa.select(*columns).where(Run.id == run_id, Run.purged.is_not(None))).one_or_none()
    if row is not None:
        raise RefusedError("purged", _sentence(row))


def _sentence(row: Any) -> str:
    reason = (row.removed_reason or "").rstrip(". ")
    return (
        f"{run_name(row.id)} “{row.name}” was removed by {row.removed_by} on {_day(row.removed)} ({reason}), and its "
        f"results were purged by {row.purged_by} on {_day(row.purged)}. They had the digest sha256 "
        f"{row.purged_digest}, of the campaign sha256 {row.campaign_digest}. "
        "Its number is never reused; its history is stored"
    )


def _day(at: float) -> str:
    return f"{datetime.datetime.fromtimestamp(at, datetime.UTC):%Y-%m-%d, %H:%M UTC}"
