"""what people write on runs, and what the list shows and searches without reading the wide rows"""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    op.add_column("runs", sa.Column("upper_bound", sa.Double(), nullable=True))
    op.add_column("runs", sa.Column("best_so_far", sa.JSON(), nullable=False, server_default="[]"))
    op.add_column("runs", sa.Column("pinned", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("runs", sa.Column("notes", sa.Text(), nullable=False, server_default=""))
    op.create_index("ix_campaigns_name", "campaigns", ["name", "digest"])
    _bounds_of_earlier_runs()


def _bounds_of_earlier_runs() -> None:
    """The bound is in the summary of a run that has ended."""
    runs = sa.table("runs", sa.column("id"), sa.column("summary", sa.JSON), sa.column("upper_bound"))
    bind = op.get_bind()
    for run_id, summary in bind.execute(sa.select(runs.c.id, runs.c.summary)).all():
        statistics = (summary or {}).get("statistics") or {}
        if statistics.get("upper_bound") is not None:
            values = {"upper_bound": statistics["upper_bound"]}
            bind.execute(sa.update(runs).where(runs.c.id == run_id).values(**values))
