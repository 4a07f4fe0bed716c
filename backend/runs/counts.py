"""The numbers of evaluations of a run (all, failed, excluded): the single source for everything that shows them.

For a run with a verdict they are those on which the verdict is based (`summary.evaluations`), for any other the totals
of its stage rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sqlalchemy as sa
from pydantic import BaseModel

from backend.db.tables import Run, Stage

NAMES = ("evaluations", "failed_evaluations", "excluded_evaluations")
_TOLD = ("stored", "failed", "excluded", "counted")
COLUMNS = (
    Run.evaluations,
    Run.failed_evaluations,
    *(Run.summary["evaluations", key].as_integer().label(f"verdict_{key}") for key in _TOLD),
)
"""The columns that `of` needs; the first two are totals of the stage rows, written in the same transaction."""


def of(row: Any, excluded: int) -> dict[str, int]:
    """The counts of one run; excluded: the total of its stage rows."""
    stored, *others, counted = (getattr(row, f"verdict_{key}") for key in _TOLD)
    stages = [row.evaluations, row.failed_evaluations, excluded]
    chosen = stages if stored is None or None in others else [stored + (counted or 0), *others]
    return dict(zip(NAMES, chosen, strict=True))


def columns(schema: type[BaseModel]) -> list[Any]:
    """What is read of the stages for this schema: their evaluations are those that are stored or only counted."""
    named = {"evaluations": Stage.evaluations + Stage.counted, "stored": Stage.evaluations}
    read = [name for name in schema.model_fields if name != "so_far"]
    return [(named[name] if name in named else getattr(Stage, name)).label(name) for name in read]


def excluded(reader: sa.Connection, ids: Sequence[int]) -> dict[int, int]:
    """The total of excluded evaluations of each run; runs without any are omitted."""
    if not ids:
        return {}
    total = sa.func.sum(Stage.excluded)
    query = sa.select(Stage.run_id, total).where(Stage.run_id.in_(ids), Stage.excluded > 0).group_by(Stage.run_id)
    return {run_id: int(number) for run_id, number in reader.execute(query)}
