"""which simulators a worker has, and which one a run needs

Runs of before need nothing: any worker may claim them, as until now.
"""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    op.add_column("workers", sa.Column("simulators", sa.JSON(), nullable=False, server_default="[]"))
    op.add_column("runs", sa.Column("needs", sa.String(160), nullable=True))
