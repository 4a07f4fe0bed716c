"""The lowest value that a run has found so far: of every stage that evaluates the question of its campaign."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Run, Stage
from campaigns.stages.found import declared


def own_question() -> sa.ColumnElement[bool]:
    """Whether a stage evaluates the question of its campaign."""
    return Stage.kind.in_(_kinds())


def lowered(connection: sa.Connection, run_id: int, kind: str, method: str | None, cost: float) -> None:
    """A stage of the kind has evaluated a cost; `method` is that of a search."""
    if kind not in _kinds():
        return
    lower = sa.or_(Run.worst_cost.is_(None), Run.worst_cost > cost)
    connection.execute(sa.update(Run).where(Run.id == run_id, lower).values(worst_cost=cost, worst_method=method))


def _kinds() -> list[str]:
    return [stage.kind for stage in declared().values() if stage.against]
