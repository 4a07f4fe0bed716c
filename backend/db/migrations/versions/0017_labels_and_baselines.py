"""labels of runs, and the baselines that they were launched with"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"


def upgrade() -> None:
    op.create_table(
        "run_labels",
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("key", sa.String(40), nullable=False),
        sa.Column("value", sa.String(200), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", "key"),
    )
    op.create_index("ix_run_labels_value", "run_labels", ["key", "value", "run_id"])
    op.create_table(
        "run_baselines",
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("asked", sa.String(300), nullable=False),
        sa.Column("baseline", sa.Integer(), nullable=True),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["baseline"], ["runs.id"]),
        sa.PrimaryKeyConstraint("run_id"),
    )
