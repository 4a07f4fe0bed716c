"""results as types: a finding holds all its own evidence, every stage's result names its stage"""

import sqlalchemy as sa
from alembic import op

from backend.db import signed
from backend.db.digest import results_digest
from campaigns.results import earlier

revision = "0010"
down_revision = "0009"

_STAGES = sa.table(
    "stages", sa.column("run_id", sa.Integer), sa.column("position", sa.Integer), sa.column("kind", sa.String),
    sa.column("result", sa.JSON),
)  # fmt: skip
_FINDINGS = sa.table(
    "findings", sa.column("run_id", sa.Integer), sa.column("label", sa.String), sa.column("validation", sa.JSON),
    sa.column("slices", sa.JSON), sa.column("boundary", sa.JSON), sa.column("closest", sa.JSON),
)  # fmt: skip
_TRACES = sa.table("traces", sa.column("run_id", sa.Integer), sa.column("name", sa.String), sa.column("meta", sa.JSON))
_RUNS = sa.table("runs", sa.column("id", sa.Integer), sa.column("summary", sa.JSON))


def upgrade() -> None:
    for name in ("slices", "boundary", "closest"):
        op.add_column("findings", sa.Column(name, sa.JSON(), nullable=True))
    connection = op.get_bind()
    for run_id in connection.scalars(sa.select(_RUNS.c.id).order_by(_RUNS.c.id)).all():
        if not signed.is_signed(connection, run_id):
            _upgrade(connection, run_id)
            continue
        before = results_digest(connection, run_id, evidence=False)
        _upgrade(connection, run_id)
        after = results_digest(connection, run_id, evidence=False)
        signed.bind_again(connection, run_id, before, after, "migration 0010")


def _upgrade(connection: sa.Connection, run_id: int) -> None:
    """One run after the other: results may be large."""
    stages = connection.execute(sa.select(_STAGES).where(_STAGES.c.run_id == run_id)).all()
    for stage in stages:
        if not stage.result:
            continue
        if stage.kind == "validate":
            _findings(connection, run_id, stage.result)
        of = (_STAGES.c.run_id == run_id, _STAGES.c.position == stage.position)
        upgraded = earlier.upgraded(stage.kind, stage.result)
        connection.execute(sa.update(_STAGES).where(*of).values(result=upgraded))
    for name, meta in connection.execute(
        sa.select(_TRACES.c.name, _TRACES.c.meta).where(_TRACES.c.run_id == run_id)
    ).all():
        of = (_TRACES.c.run_id == run_id, _TRACES.c.name == name)
        connection.execute(sa.update(_TRACES).where(*of).values(meta=earlier.head(meta or {})))
    summary = connection.scalar(sa.select(_RUNS.c.summary).where(_RUNS.c.id == run_id))
    if summary and (parts := earlier.verdict(summary)) is not None:
        connection.execute(sa.update(_RUNS).where(_RUNS.c.id == run_id).values(summary=parts))


def _findings(connection: sa.Connection, run_id: int, validate: dict[str, object]) -> None:
    mine = sa.select(_FINDINGS.c.label, _FINDINGS.c.validation).where(_FINDINGS.c.run_id == run_id)
    for label, validation in connection.execute(mine).all():
        evidence = earlier.of_finding(label, validate)
        values = {key: evidence[key] for key in ("slices", "boundary", "closest")}
        values["validation"] = validation or evidence["validation"]
        of = (_FINDINGS.c.run_id == run_id, _FINDINGS.c.label == label)
        connection.execute(sa.update(_FINDINGS).where(*of).values(**values))
