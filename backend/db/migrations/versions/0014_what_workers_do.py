"""what a worker does besides the stages of its run, and when the last one stopped

The row of a worker that stops in an orderly way is deleted; the pages say when one was last seen all the same.
"""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    op.add_column("workers", sa.Column("doing", sa.JSON(), nullable=True))
    op.add_column("catalogue", sa.Column("departed", sa.Double(), nullable=True))
