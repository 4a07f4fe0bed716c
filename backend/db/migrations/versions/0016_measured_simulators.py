"""what `clearance check-simulator` measured of simulators"""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"


def upgrade() -> None:
    op.create_table(
        "simulator_measurements",
        sa.Column("simulator", sa.String(160), primary_key=True),
        sa.Column("digest", sa.String(128), primary_key=True),
        sa.Column("measured", sa.Double(), nullable=False),
        sa.Column("host", sa.String(120), nullable=False),
        sa.Column("result", sa.JSON(), nullable=False),
    )
