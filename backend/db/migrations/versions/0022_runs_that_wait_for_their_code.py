"""runs that wait for the code that began them, and runs that begin with another run's evaluations"""

import sqlalchemy as sa
from alembic import op

revision = "0022"
down_revision = "0021"


def upgrade() -> None:
    op.create_table(
        "run_refusals",
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("installation", sa.String(64), primary_key=True),
        sa.Column("text", sa.Text(), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
    )
    op.add_column("workers", sa.Column("installation", sa.String(64), nullable=False, server_default=""))
    op.add_column("runs", sa.Column("carries", sa.Boolean(), nullable=False, server_default=sa.false()))
