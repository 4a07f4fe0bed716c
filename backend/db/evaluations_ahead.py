"""Reads and writes evaluations that were completed before an earlier one of their stage.

The chunks contain a stage's evaluations without a gap; these wait next to them.
"""

from __future__ import annotations

import numpy as np
import sqlalchemy as sa

from backend.db.tables import EvaluationAhead
from campaigns.stored.records import Ahead, Columns


def read(connection: sa.Connection, run_id: int, position: int) -> Ahead | None:
    of = (EvaluationAhead.run_id == run_id, EvaluationAhead.position == position)
    rows = connection.execute(sa.select(EvaluationAhead).where(*of).order_by(EvaluationAhead.place)).all()
    if not rows:
        return None
    columns = Columns(
        points=np.array([np.frombuffer(row.point, dtype="<f8") for row in rows]),
        costs=np.array([np.frombuffer(row.costs, dtype="<f8") for row in rows]),
        status=np.array([row.status for row in rows], dtype=np.uint8),
        seconds=np.array([row.seconds for row in rows]),
        reasons={row.place: row.reason for row in rows if row.reason},
    )
    return Ahead(np.array([row.place for row in rows], dtype=np.int64), columns)


def of_run(connection: sa.Connection, run_id: int) -> dict[int, Ahead]:
    """Those of every stage, by its position."""
    stages = connection.scalars(sa.select(EvaluationAhead.position).where(EvaluationAhead.run_id == run_id).distinct())
    return {at: ahead for at in stages.all() if (ahead := read(connection, run_id, at)) is not None}


def store(connection: sa.Connection, run_id: int, position: int, done: int, ahead: Ahead) -> None:
    """Drop those that the first `done` evaluations of the stage now contain, and add these."""
    of = (EvaluationAhead.run_id == run_id, EvaluationAhead.position == position)
    connection.execute(sa.delete(EvaluationAhead).where(*of, EvaluationAhead.place < done))
    columns = ahead.columns
    rows = [
        {
            "run_id": run_id,
            "position": position,
            "place": index,
            "point": np.ascontiguousarray(columns.points[row], dtype="<f8").tobytes(),
            "costs": np.ascontiguousarray(columns.costs[row], dtype="<f8").tobytes(),
            "status": int(columns.status[row]),
            "seconds": float(columns.seconds[row]),
            "reason": columns.reasons.get(index, ""),
        }
        for row, index in enumerate(ahead.indices.tolist())
    ]
    if rows:
        connection.execute(sa.insert(EvaluationAhead), rows)
