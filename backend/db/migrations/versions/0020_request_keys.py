"""one table of Idempotency-Keys for all writes, and the sources of components that are not shipped

A request that was sent before the migration and is repeated after it returns the run or sweep of the first. Runs of
before have no stored sources.
"""

from typing import Any

import sqlalchemy as sa
from alembic import op

from campaigns.runs import run_name, sweep_name

revision = "0020"
down_revision = "0019"

_OLD = sa.table("idempotency_keys", *(sa.column(name) for name in ("key", "user", "body", "run_id", "created")))
_SWEEPS = sa.table("sweeps", *(sa.column(name) for name in ("id", "owner", "key", "body", "created")))
_NEW = sa.table(
    "request_keys",
    *(sa.column(name) for name in ("user", "operation", "key", "body", "made", "created")),
)


def upgrade() -> None:
    op.create_table(
        "request_keys",
        sa.Column("user", sa.String(64), primary_key=True),
        sa.Column("operation", sa.String(20), primary_key=True),
        sa.Column("key", sa.String(128), primary_key=True),
        sa.Column("body", sa.String(64), nullable=False),
        sa.Column("made", sa.String(300), nullable=False),
        sa.Column("answer", sa.LargeBinary(), nullable=True),
        sa.Column("created", sa.Double(), nullable=False),
    )
    op.create_index("ix_request_keys_created", "request_keys", ["user", "created"])
    connection = op.get_bind()
    rows = [_row(row, "submit_run", run_name(row.run_id), row.user) for row in connection.execute(sa.select(_OLD))]
    of = sa.select(_SWEEPS).where(_SWEEPS.c.key.is_not(None))
    rows += [_row(row, "submit_sweep", sweep_name(row.id), row.owner) for row in connection.execute(of)]
    op.bulk_insert(_NEW, rows)
    op.drop_table("idempotency_keys")
    with op.batch_alter_table("sweeps") as batch:
        batch.drop_constraint("uq_sweeps_key", type_="unique")
        batch.drop_column("key")
        batch.drop_column("body")
    op.create_table(
        "run_sources",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("document", sa.JSON(), nullable=False),
    )
    op.create_table(
        "source_texts",
        sa.Column("digest", sa.String(64), primary_key=True),
        sa.Column("content", sa.LargeBinary(), nullable=False),
    )


def _row(row: Any, operation: str, made: str, user: str) -> dict[str, object]:
    found = {"user": user, "operation": operation, "key": row.key, "body": row.body}
    return {**found, "made": made, "created": row.created}
