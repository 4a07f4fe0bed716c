"""How many evaluations a run has, how many failed and were excluded: the one source of every place that shows them.

Of a run with a verdict the counts are those that the verdict was drawn from (`summary.evaluations`); of any other they
are the totals of its stage rows. Start reading at `of`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sqlalchemy as sa

from backend.db.tables import Run, Stage

_TOLD = ("stored", "failed", "excluded")
COLUMNS = (
    Run.evaluations,
    Run.failed_evaluations,
    *(Run.summary["evaluations", key].as_integer().label(f"verdict_{key}") for key in _TOLD),
)
"""What `of` reads of a run's row; the first two are totals of the stage rows, written in the same transaction."""


def of(row: Any, excluded: int) -> dict[str, int]:
    """The counts of one run; excluded: over its stage rows."""
    told = [getattr(row, f"verdict_{key}") for key in _TOLD]
    counted = [row.evaluations, row.failed_evaluations, excluded]
    chosen = counted if any(number is None for number in told) else told
    return dict(zip(("evaluations", "failed_evaluations", "excluded_evaluations"), chosen, strict=True))


def excluded(reader: sa.Connection, ids: Sequence[int]) -> dict[int, int]:
    """The excluded evaluations over the stages of each run; runs without any are left out."""
    if not ids:
        return {}
    total = sa.func.sum(Stage.excluded)
    query = sa.select(Stage.run_id, total).where(Stage.run_id.in_(ids), Stage.excluded > 0).group_by(Stage.run_id)
    return {run_id: int(number) for run_id, number in reader.execute(query)}
