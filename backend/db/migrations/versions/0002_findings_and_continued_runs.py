"""which stages found what after how many evaluations; runs that continue another"""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    op.add_column("findings", sa.Column("found", sa.JSON(), nullable=False, server_default="[]"))
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("continues", sa.Integer(), nullable=True))
        batch_op.create_foreign_key("fk_runs_continues", "runs", ["continues"], ["id"])
