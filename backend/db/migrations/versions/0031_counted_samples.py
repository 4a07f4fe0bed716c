"""samples of which only a part is stored: the blocks of one under way, and how many are only counted"""

import sqlalchemy as sa
from alembic import op

revision = "0031"
down_revision = "0030"
COUNT = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
WIDENED = {"runs": ("evaluations", "planned", "failed_evaluations"), "stages": ("planned", "failed", "excluded")}


def upgrade() -> None:
    if op.get_bind().dialect.name != "sqlite":
        for table, columns in WIDENED.items():
            for column in columns:
                op.alter_column(table, column, type_=COUNT)
    op.add_column("stages", sa.Column("counted", COUNT, nullable=False, server_default="0"))
    op.add_column("stages", sa.Column("violations", COUNT, nullable=False, server_default="0"))
    op.create_table(
        "sample_blocks",
        sa.Column("run_id", sa.Integer(), primary_key=True),
        sa.Column("position", sa.Integer(), primary_key=True),
        sa.Column("first", COUNT, primary_key=True),
        sa.Column("data", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(["run_id", "position"], ["stages.run_id", "stages.position"], ondelete="CASCADE"),
    )
    op.create_table(
        "sample_shares",
        sa.Column("run_id", sa.Integer(), primary_key=True),
        sa.Column("position", sa.Integer(), primary_key=True),
        sa.Column("first", COUNT, primary_key=True),
        sa.Column("worker", sa.String(80), nullable=False),
        sa.ForeignKeyConstraint(["run_id", "position"], ["stages.run_id", "stages.position"], ondelete="CASCADE"),
    )
