"""when a run last stored an evaluation, so that one that stands still is known at once"""

import sqlalchemy as sa
from alembic import op

revision = "0028"
down_revision = "0027"


def upgrade() -> None:
    op.add_column("runs", sa.Column("advanced", sa.Double(), nullable=True))
