"""runs that were removed, and what stays of those that were purged"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"

LISTED = (
    "pinned", "state", "verdict", "owner", "name", "campaign_digest", "tags", "created", "started", "finished",
    "threshold", "nominal_cost", "worst_cost", "worst_method", "evaluations", "failed_evaluations", "upper_bound",
)  # fmt: skip
ADDED = {
    "removed": sa.Double(),
    "removed_by": sa.String(length=64),
    "removed_reason": sa.Text(),
    "purged": sa.Double(),
    "purged_by": sa.String(length=64),
    "purged_digest": sa.String(length=64),
}


def upgrade() -> None:
    listed = op.get_bind().dialect.name == "sqlite"  # the index that the run list reads instead of the wide rows
    if listed:
        op.drop_index("ix_runs_list", "runs")
    with op.batch_alter_table("runs", schema=None) as batch_op:
        for name, kind in ADDED.items():
            batch_op.add_column(sa.Column(name, kind, nullable=True))
    if listed:
        op.create_index("ix_runs_list", "runs", [*LISTED, "removed"])
