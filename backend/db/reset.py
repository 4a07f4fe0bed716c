"""Puts a run back to where it was when it was submitted, and tells which failed runs have nothing of use stored."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import refusals, sample_seeds, sizes
from backend.db.tables import (
    CampaignRow,
    EvaluationAhead,
    EvaluationChunk,
    Finding,
    Run,
    RunSources,
    SampleBlock,
    SampleShare,
    Stage,
    Trace,
)
from campaigns.results.base import OK

RESULTS = (EvaluationAhead, EvaluationChunk, SampleBlock, SampleShare, Stage, Finding, Trace, RunSources)
"""Tables of what is stored of a run while it is carried out."""


def empty(writer: sa.Connection, run_id: int) -> None:
    """Delete what was evaluated, and what follows from it."""
    for table in RESULTS:
        writer.execute(sa.delete(table).where(table.run_id == run_id))
    refusals.clear(writer, run_id)
    of = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    values: dict[str, object] = {
        "attempts": 0,
        "losses": 0,
        "started": None,
        "worker": None,
        "flown": None,
        "error": None,
        "evaluations": 0,
        "failed_evaluations": 0,
    }
    values |= dict.fromkeys(("nominal_cost", "worst_cost", "worst_method", "made_again", "later"))
    values |= {"best_so_far": [], "not_before": 0.0}
    if seed := sample_seeds.again(writer, run_id):
        values |= {"sample_seed": seed.value}
    size = sizes.of_document(writer.execute(of).scalar_one())
    writer.execute(sa.update(Run).where(Run.id == run_id).values(**values, size=size))


def useless(reader: sa.Connection, run_id: int) -> bool:
    """Whether a run has evaluations, of which none has a value: judged again, they would fail it again."""
    some = sa.select(Run.id).where(Run.id == run_id, Run.evaluations > 0)
    best = sa.select(Stage.run_id).where(Stage.run_id == run_id, Stage.best.is_not(None))
    ahead = sa.select(EvaluationAhead.run_id).where(EvaluationAhead.run_id == run_id, EvaluationAhead.status == OK)
    return bool(reader.scalar(sa.select(some.exists() & ~best.exists() & ~ahead.exists())))
