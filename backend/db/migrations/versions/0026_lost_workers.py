"""workers that a run has lost since its last result are counted apart from its failed attempts; workers are drained"""

import sqlalchemy as sa
from alembic import op

revision = "0026"
down_revision = "0025"


def upgrade() -> None:
    op.add_column("runs", sa.Column("losses", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("workers", sa.Column("draining", sa.Boolean(), nullable=False, server_default=sa.false()))
