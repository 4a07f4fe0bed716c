"""what flew a run, stored as its first stage begins; the code that workers publish; earlier runs have nothing stored"""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    op.create_table(
        "code_versions",
        sa.Column("digest", sa.String(length=64), primary_key=True),
        sa.Column("modules", sa.JSON(), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
    )
    op.add_column("runs", sa.Column("flown", sa.JSON(), nullable=True))
    op.add_column("catalogue", sa.Column("code", sa.String(length=64), nullable=True))
