"""what a run stores, for the quota of a user

Counted of the runs that are there: campaign, evaluations with their reasons, traces, original text. Purged runs have 0.
"""

import sqlalchemy as sa
from alembic import op

revision = "0021"
down_revision = "0020"

_BLOBS = ("points", "costs", "status", "seconds")
_RUNS = sa.table("runs", *(sa.column(name) for name in ("id", "size", "campaign_digest", "purged")))


def upgrade() -> None:
    op.add_column("runs", sa.Column("size", sa.BigInteger(), nullable=False, server_default="0"))
    chunks = sa.table("evaluation_chunks", *(sa.column(name) for name in ("run_id", "reasons", *_BLOBS)))
    traces = sa.table("traces", sa.column("run_id"), sa.column("data"))
    texts = sa.table("run_texts", sa.column("run_id"), sa.column("text"))
    length = sa.func.length
    written = length(sa.cast(texts.c.text, sa.LargeBinary))
    if op.get_bind().dialect.name == "postgresql":  # which would read escapes in that
        written = sa.func.octet_length(texts.c.text)
    stored = [
        (chunks, sum((length(chunks.c[name]) for name in _BLOBS), length(sa.cast(chunks.c.reasons, sa.Text)))),
        (traces, length(traces.c.data)),
        (texts, written),
    ]
    campaigns = sa.table("campaigns", sa.column("digest"), sa.column("document"))
    document_size = sa.select(length(sa.cast(campaigns.c.document, sa.Text)))
    document_size = document_size.where(campaigns.c.digest == _RUNS.c.campaign_digest)
    op.execute(sa.update(_RUNS).where(_RUNS.c.purged.is_(None)).values(size=document_size.scalar_subquery()))
    for table, size in stored:
        of = sa.select(sa.func.coalesce(sa.func.sum(size), 0)).where(table.c.run_id == _RUNS.c.id).scalar_subquery()
        op.execute(sa.update(_RUNS).values(size=_RUNS.c.size + of))
