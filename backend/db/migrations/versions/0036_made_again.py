"""the lowest value that validation saw in evaluations made again, which no stage stores"""

from collections.abc import Iterator, Mapping
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0036"
down_revision = "0035"

_RUNS = sa.table("runs", sa.column("id"), sa.column("threshold", sa.Double), sa.column("made_again", sa.Double))
_STAGES = sa.table("stages", sa.column("run_id"), sa.column("kind"), sa.column("result", sa.JSON))
_FINDINGS = sa.table("findings", sa.column("run_id"), sa.column("validation", sa.JSON))


def upgrade() -> None:
    op.add_column("runs", sa.Column("made_again", sa.Double, nullable=True))
    connection = op.get_bind()
    validated = sa.select(_STAGES.c.run_id, _STAGES.c.result).where(_STAGES.c.kind == "validate")
    for run_id in connection.scalars(sa.select(_RUNS.c.id)).all():
        mine = _RUNS.c.id == run_id
        limit = connection.scalar(sa.select(_RUNS.c.threshold).where(mine))
        results = connection.execute(validated.where(_STAGES.c.run_id == run_id)).all()
        values = [value for row in results for value in _of_result(row.result or {}, limit)]
        findings = sa.select(_FINDINGS.c.validation).where(_FINDINGS.c.run_id == run_id)
        values += [value for case in connection.scalars(findings).all() for value in _of_case(case)]
        if values:
            connection.execute(sa.update(_RUNS).where(mine).values(made_again=min(values)))


def _of_result(result: Mapping[str, Any], limit: float | None) -> Iterator[float]:
    for case in (result.get("nominal"), *(one.get("validation") for one in result.get("incumbents") or [])):
        yield from _of_case(case)
    spot = result.get("spot_checks") or {}
    if spot.get("violating") and limit is not None:  # the values themselves were not stored
        yield limit
    if spot.get("at"):
        yield spot["at"]["reference"]


def _of_case(case: Mapping[str, Any] | None) -> Iterator[float]:
    case = case or {}
    others = ((case.get(name) or {}).get("cost") for name in ("half_step", "integrator", "again"))
    values = (case.get("cost"), *others, *((case.get("repeats") or {}).get("values") or ()))
    yield from (value for value in values if isinstance(value, int | float))
