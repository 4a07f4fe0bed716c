"""What a run stores, counted from its rows."""

from __future__ import annotations

import json

import sqlalchemy as sa

from backend.db.tables import CampaignRow, EvaluationChunk, Run, RunText, Trace


def stored_size(reader: sa.Connection, run_id: int) -> int:
    """The size of its campaign, its evaluations with their reasons, its traces and its original text [bytes]."""
    chunks = reader.execute(sa.select(EvaluationChunk.__table__).where(EvaluationChunk.run_id == run_id)).all()
    columns = (column for c in chunks for column in (c.points, c.costs, c.status, c.seconds))
    traces = reader.scalars(sa.select(Trace.data).where(Trace.run_id == run_id))
    texts = reader.scalars(sa.select(RunText.text).where(RunText.run_id == run_id))
    document = (
        sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    )
    written = [*(json.dumps(c.reasons) for c in chunks), json.dumps(reader.scalar(document)), *texts]
    return sum(map(len, columns)) + sum(map(len, traces)) + sum(len(text.encode()) for text in written)
