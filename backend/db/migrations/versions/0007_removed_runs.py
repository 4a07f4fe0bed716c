"""runs that were removed, and what stays of those that were purged"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"

ADDED = {
    "removed": sa.Double(),
    "removed_by": sa.String(length=64),
    "removed_reason": sa.Text(),
    "purged": sa.Double(),
    "purged_by": sa.String(length=64),
    "purged_digest": sa.String(length=64),
}


def upgrade() -> None:
    for name, kind in ADDED.items():
        op.add_column("runs", sa.Column(name, kind, nullable=True))
