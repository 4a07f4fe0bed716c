"""the seed of a run's independent sample, drawn at its launch, and the question that a campaign asks"""

from __future__ import annotations

import hashlib
import json

import sqlalchemy as sa
from alembic import op

revision = "0024"
down_revision = "0023"

_ASKED = ("scenario", "simulator", "uncertain", "correlations", "criterion")
_STATED = ("requirements", "threshold", "from_centre")


def upgrade() -> None:
    op.add_column("runs", sa.Column("sample_seed", sa.BigInteger(), nullable=True))
    op.add_column("runs", sa.Column("sample_seed_stated", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("campaigns", sa.Column("question", sa.String(64), nullable=True))
    op.create_index("ix_campaigns_question", "campaigns", ["question"])
    _fill(op.get_bind())


def _fill(connection: sa.Connection) -> None:
    campaigns = sa.table(
        "campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON), sa.column("question", sa.String)
    )
    for digest in connection.scalars(sa.select(campaigns.c.digest)).all():
        mine = campaigns.c.digest == digest
        document = connection.scalar(sa.select(campaigns.c.document).where(mine)) or {}
        content = {key: document[key] for key in _ASKED if document.get(key)}
        content["criterion"] = {k: v for k, v in (document.get("criterion") or {}).items() if k not in _STATED}
        canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
        question = hashlib.sha256(canonical.encode()).hexdigest()
        connection.execute(sa.update(campaigns).where(mine).values(question=question))
