"""the counts of the whole run list are read from an index of their own"""

import sqlalchemy as sa
from alembic import op

revision = "0029"
down_revision = "0028"


def upgrade() -> None:
    if op.get_bind().dialect.name != "sqlite":  # see 0027
        return
    only = sa.text("removed IS NULL AND state IS NOT NULL")  # the second keeps other queries of the list away
    op.create_index("ix_runs_counts", "runs", ["state", "verdict"], sqlite_where=only)
