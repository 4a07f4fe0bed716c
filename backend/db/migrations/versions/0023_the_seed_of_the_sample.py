"""the seed of a run's independent sample, drawn at its launch"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0023"
down_revision = "0022"


def upgrade() -> None:
    op.add_column("runs", sa.Column("sample_seed", sa.BigInteger(), nullable=True))
    op.add_column("runs", sa.Column("sample_seed_stated", sa.Boolean(), nullable=False, server_default=sa.false()))
