"""Which runs are variants of a sweep. They are of other values than the campaign they were made from."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Run, SweepRun


def in_sweep() -> sa.ColumnElement[bool]:
    return sa.exists().where(SweepRun.run_id == Run.id)
