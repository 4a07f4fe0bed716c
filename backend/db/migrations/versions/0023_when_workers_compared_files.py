"""when a worker last compared its files with what it has published"""

import sqlalchemy as sa
from alembic import op

revision = "0023"
down_revision = "0022"


def upgrade() -> None:
    op.add_column("workers", sa.Column("compared", sa.Double(), nullable=False, server_default="0"))
