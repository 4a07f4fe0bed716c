"""the seed of a run's independent sample, drawn at its launch, and a column for the question of a campaign (0032)"""

import sqlalchemy as sa
from alembic import op

revision = "0024"
down_revision = "0023"


def upgrade() -> None:
    op.add_column("runs", sa.Column("sample_seed", sa.BigInteger(), nullable=True))
    op.add_column("runs", sa.Column("sample_seed_stated", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("campaigns", sa.Column("question", sa.String(64), nullable=True))
    op.create_index("ix_campaigns_question", "campaigns", ["question"])
