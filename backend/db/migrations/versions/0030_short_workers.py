"""which workers begin no run because their disk is short, so that a run that waits for them says so"""

import sqlalchemy as sa
from alembic import op

revision = "0030"
down_revision = "0029"


def upgrade() -> None:
    op.add_column("workers", sa.Column("short", sa.Boolean(), nullable=False, server_default=sa.false()))
