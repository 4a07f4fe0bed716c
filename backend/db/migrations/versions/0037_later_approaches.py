"""the lowest value that validation saw beyond the horizon, which no stage stores; what is known when a run is signed"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0037"
down_revision = "0036"

_RUNS = sa.table("runs", sa.column("id"), sa.column("later", sa.Double))
_STAGES = sa.table("stages", sa.column("run_id"), sa.column("kind"), sa.column("result", sa.JSON))


def upgrade() -> None:
    op.add_column("runs", sa.Column("later", sa.Double, nullable=True))
    op.add_column("signoffs", sa.Column("known", sa.JSON, nullable=True))
    connection = op.get_bind()
    # Not the whole results: those of many runs do not fit into memory.
    beyond = sa.select(_STAGES.c.run_id, _STAGES.c.result["encounter", "beyond"].label("beyond"))
    values: dict[int, list[float]] = defaultdict(list)
    for row in connection.execute(beyond.where(_STAGES.c.kind == "validate")):
        values[row.run_id] += _values(row.beyond or {})
    for run_id, seen in values.items():
        if seen:
            connection.execute(sa.update(_RUNS).where(_RUNS.c.id == run_id).values(later=min(seen)))


def _values(beyond: Any) -> Iterator[float]:
    lowest = (beyond.get("lowest") or {}).get("value")
    if beyond.get("closer") and isinstance(lowest, int | float):
        yield lowest
    if beyond.get("unknown"):
        yield -math.inf
