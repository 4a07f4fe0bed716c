"""the same question over time: campaigns without their seed, sweeps, webhooks"""

import hashlib
import json

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    op.add_column("campaigns", sa.Column("seedless", sa.String(64), nullable=True))
    op.create_index("ix_campaigns_seedless", "campaigns", ["seedless"])
    _fill(op.get_bind())
    op.create_table(
        "sweeps",
        sa.Column("id", sa.Integer(), autoincrement=True, primary_key=True),
        sa.Column("name", sa.String(120), nullable=False),
        sa.Column("campaign_name", sa.String(120), nullable=False),
        sa.Column("path", sa.String(120), nullable=False),
        sa.Column("title", sa.String(400), nullable=False),
        sa.Column("unit", sa.String(30), nullable=False),
        sa.Column("nominal", sa.Double(), nullable=True),
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
        sa.Column("key", sa.String(128), nullable=True),
        sa.Column("body", sa.String(64), nullable=False),
        sa.UniqueConstraint("owner", "key", name="uq_sweeps_key"),
    )
    op.create_table(
        "sweep_runs",
        sa.Column("sweep_id", sa.Integer(), sa.ForeignKey("sweeps.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("position", sa.Integer(), primary_key=True),
        sa.Column("value", sa.Double(), nullable=False),
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id"), nullable=False),
    )
    op.create_index("ix_sweep_runs_run_id", "sweep_runs", ["run_id"], unique=True)
    op.create_table(
        "webhook_targets",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("since", sa.Double(), nullable=False),
    )
    op.create_table(
        "webhook_deliveries",
        sa.Column("id", sa.String(40), primary_key=True),
        sa.Column("target", sa.String(16), sa.ForeignKey("webhook_targets.id"), nullable=False),
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id"), nullable=True),
        sa.Column("type", sa.String(40), nullable=False),
        sa.Column("body", sa.Text(), nullable=False),
        sa.Column("state", sa.String(12), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("not_before", sa.Double(), nullable=False),
        sa.Column("attempted", sa.Double(), nullable=True),
        sa.Column("status", sa.Integer(), nullable=True),
        sa.Column("error", sa.Text(), nullable=True),
        sa.Column("delivered", sa.Double(), nullable=True),
        sa.UniqueConstraint("target", "run_id", name="uq_webhook_deliveries_run"),
    )
    op.create_index("ix_webhook_deliveries_created", "webhook_deliveries", ["created"])
    op.create_index("ix_webhook_deliveries_due", "webhook_deliveries", ["target", "state", "not_before"])


def _fill(connection: sa.Connection) -> None:
    campaigns = sa.table(
        "campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON), sa.column("seedless", sa.String)
    )
    for digest in connection.scalars(sa.select(campaigns.c.digest)).all():
        mine = campaigns.c.digest == digest
        document = connection.scalar(sa.select(campaigns.c.document).where(mine))
        rest = {key: value for key, value in (document or {}).items() if key != "seed"}
        canonical = json.dumps(rest, sort_keys=True, separators=(",", ":"), allow_nan=False)
        connection.execute(
            sa.update(campaigns).where(mine).values(seedless=hashlib.sha256(canonical.encode()).hexdigest())
        )
