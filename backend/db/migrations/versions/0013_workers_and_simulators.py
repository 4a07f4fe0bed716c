"""which simulators a worker has, and which one a run needs

Runs of before need nothing: any worker may claim them, as until now.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    with op.batch_alter_table("workers") as batch:
        batch.add_column(sa.Column("simulators", sa.JSON(), nullable=False, server_default="[]"))
    with op.batch_alter_table("runs") as batch:
        batch.add_column(sa.Column("needs", sa.String(160), nullable=True))
