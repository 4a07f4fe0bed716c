"""the index of the run list is in its order, without removed runs"""

import sqlalchemy as sa
from alembic import op

revision = "0027"
down_revision = "0026"

LISTED = (
    "pinned", "id", "state", "verdict", "owner", "token", "name", "tags", "campaign_digest", "created", "started",
    "finished", "threshold", "nominal_cost", "worst_cost", "worst_method", "evaluations", "failed_evaluations",
    "upper_bound",
)  # fmt: skip


def upgrade() -> None:
    if op.get_bind().dialect.name != "sqlite":  # where the run list reads it instead of the wide rows
        return
    op.drop_index("ix_runs_list", "runs", if_exists=True)  # of databases that were made before this revision
    op.create_index("ix_runs_list", "runs", LISTED, sqlite_where=sa.text("removed IS NULL"))
    op.create_index("ix_runs_removed", "runs", ["purged", "removed"], sqlite_where=sa.text("removed IS NOT NULL"))
