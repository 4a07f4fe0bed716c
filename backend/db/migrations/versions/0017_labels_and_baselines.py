"""labels of runs, and the baselines that they were launched with"""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"


def upgrade() -> None:
    op.create_table(
        "run_labels",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("key", sa.String(40), primary_key=True),
        sa.Column("value", sa.String(200), nullable=False),
    )
    op.create_index("ix_run_labels_value", "run_labels", ["key", "value", "run_id"])
    op.create_table(
        "run_baselines",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("asked", sa.String(300), nullable=False),
        sa.Column("baseline", sa.Integer(), sa.ForeignKey("runs.id"), nullable=True),
    )
