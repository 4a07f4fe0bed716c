"""samples of which only the lowest evaluations are stored: the blocks of one under way, and how many are only counted"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0031"
down_revision = "0030"


def upgrade() -> None:
    op.add_column("stages", sa.Column("counted", sa.BigInteger(), nullable=False, server_default="0"))
    op.add_column("stages", sa.Column("violations", sa.BigInteger(), nullable=False, server_default="0"))
    op.create_table(
        "sample_blocks",
        sa.Column("run_id", sa.Integer(), primary_key=True),
        sa.Column("position", sa.Integer(), primary_key=True),
        sa.Column("first", sa.BigInteger(), primary_key=True),
        sa.Column("data", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(["run_id", "position"], ["stages.run_id", "stages.position"], ondelete="CASCADE"),
    )
