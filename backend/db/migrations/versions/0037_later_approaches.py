"""the lowest value that validation saw beyond the horizon, which no stage stores; what is known when a run is signed"""

import math
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
    validated = sa.select(_STAGES.c.run_id, _STAGES.c.result).where(_STAGES.c.kind == "validate")
    for run_id, result in connection.execute(validated).all():
        if values := [*_of_result(result or {})]:
            connection.execute(sa.update(_RUNS).where(_RUNS.c.id == run_id).values(later=min(values)))


def _of_result(result: Any) -> Iterator[float]:
    beyond = (result.get("encounter") or {}).get("beyond") or {}
    if beyond.get("closer") and beyond.get("lowest"):
        yield beyond["lowest"]["value"]
    if beyond.get("unknown"):
        yield -math.inf
