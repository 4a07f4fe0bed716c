"""runs keep what their components meant; earlier runs have nothing to keep"""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    op.create_table(
        "catalogue_snapshots",
        sa.Column("digest", sa.String(length=64), primary_key=True),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
    )
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("snapshot", sa.String(length=64), nullable=True))
        batch_op.create_foreign_key("fk_runs_snapshot", "catalogue_snapshots", ["snapshot"], ["digest"])
