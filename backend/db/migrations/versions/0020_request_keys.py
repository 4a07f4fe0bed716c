"""one table of Idempotency-Keys for all writes, and the sources of components that are not shipped

A request that was sent before the migration and is repeated after it returns the run or sweep of the first. Runs of
before have no stored sources.

Revision ID: 0020
Revises: 0019
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from alembic import op

from campaigns.runs import run_name, run_number, sweep_name, sweep_number

revision = "0020"
down_revision = "0019"
branch_labels = None
depends_on = None

_OLD = sa.table("idempotency_keys", *(sa.column(name) for name in ("key", "user", "body", "run_id", "created")))
_SWEEPS = sa.table("sweeps", *(sa.column(name) for name in ("id", "owner", "key", "body", "created")))
_NEW = sa.table(
    "request_keys",
    *(sa.column(name) for name in ("user", "operation", "key", "body", "made", "created")),
)


def upgrade() -> None:
    op.create_table(
        "request_keys",
        sa.Column("user", sa.String(64), nullable=False),
        sa.Column("operation", sa.String(20), nullable=False),
        sa.Column("key", sa.String(128), nullable=False),
        sa.Column("body", sa.String(64), nullable=False),
        sa.Column("made", sa.String(300), nullable=False),
        sa.Column("answer", sa.LargeBinary(), nullable=True),
        sa.Column("created", sa.Double(), nullable=False),
        sa.PrimaryKeyConstraint("user", "operation", "key"),
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
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id"),
    )
    op.create_table(
        "source_texts",
        sa.Column("digest", sa.String(64), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("digest"),
    )


def _row(row: Any, operation: str, made: str, user: str) -> dict[str, object]:
    found = {"user": user, "operation": operation, "key": row.key, "body": row.body}
    return {**found, "made": made, "created": row.created}


def downgrade() -> None:
    """Keys of other writes are lost: those are then done again if they are repeated."""
    op.drop_table("source_texts")
    op.drop_table("run_sources")
    op.create_table(
        "idempotency_keys",
        sa.Column("key", sa.String(128), nullable=False),
        sa.Column("user", sa.String(64), nullable=False),
        sa.Column("body", sa.String(64), nullable=False),
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("key", "user"),
    )
    with op.batch_alter_table("sweeps") as batch:
        batch.add_column(sa.Column("key", sa.String(128), nullable=True))
        batch.add_column(sa.Column("body", sa.String(64), nullable=False, server_default=""))
        batch.create_unique_constraint("uq_sweeps_key", ["owner", "key"])
    connection = op.get_bind()
    for row in connection.execute(sa.select(_NEW)).all():
        if row.operation == "submit_run":
            values = {"key": row.key, "user": row.user, "body": row.body, "created": row.created}
            connection.execute(sa.insert(_OLD).values(**values, run_id=run_number(row.made)))
        elif row.operation == "submit_sweep":
            mine = _SWEEPS.c.id == sweep_number(row.made)
            connection.execute(sa.update(_SWEEPS).where(mine).values(key=row.key, body=row.body))
    op.drop_table("request_keys")
