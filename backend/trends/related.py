"""Other runs with the same input: the same campaign, or one that differs in the seed alone. Read `related`."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run
from backend.runs import identity
from backend.runs.outcomes import Outcome, outcomes
from backend.runs.question import asked_again
from backend.runs.service import require
from backend.trends.schemas import Difference, RelatedRun, RelatedRuns
from campaigns.identity.identity import UNSTORED, Identity, changes
from campaigns.runs import run_number

MOST = 50
"""Runs that are listed; all are counted."""


def related(reader: sa.Connection, run_id: int) -> RelatedRuns:
    """Runs of the same campaign with any code, and with another seed of the same or an unknown code.

    Removed runs are omitted. 404 if there is no such run, 410 if it was purged.
    """
    require(reader, run_id)
    (own,) = outcomes(reader, [Run.id == run_id])
    ids = _ids(reader, run_id, own.campaign_digest)
    found = outcomes(reader, [Run.id.in_(ids[:MOST])])
    known = identity.of_runs(reader, [run_id, *ids[:MOST]])
    return RelatedRuns(
        runs=[_related(reader, own, known.get(run_id), other, known.get(run_number(other.id) or 0)) for other in found],
        total=len(ids),
        question=asked_again(reader, run_id),
    )


def _ids(reader: sa.Connection, run_id: int, digest: str) -> list[int]:
    """The runs of the campaign, and of those that differ in the seed alone unless their code is known to differ as
    well; the newest first."""
    seedless = reader.scalar(sa.select(CampaignRow.seedless).where(CampaignRow.digest == digest))
    same = Run.campaign_digest == digest
    wanted = same if seedless is None else sa.or_(same, CampaignRow.seedless == seedless)
    of = sa.select(Run.id, Run.campaign_digest).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    of = of.where(Run.id != run_id, Run.removed.is_(None), Run.purged.is_(None), wanted)
    rows = reader.execute(of.order_by(Run.id.desc())).all()
    known = identity.of_runs(reader, [run_id, *(row.id for row in rows if row.campaign_digest != digest)])
    then = known.get(run_id, UNSTORED)
    return [row.id for row in rows if row.campaign_digest == digest or not changes(then, known.get(row.id, UNSTORED))]


def _related(
    reader: sa.Connection, own: Outcome, then: Identity | None, other: Outcome, now: Identity | None
) -> RelatedRun:
    apart = [] if then is None or now is None else identity.apart(reader, then, now)
    differs: list[Difference] = ["seed"] if other.campaign_digest != own.campaign_digest else []
    return RelatedRun(
        **dict(other),
        differs=[*differs, "code"] if apart else differs,
        code_changes=identity.names(apart),
        code_known=own.code is not None and other.code is not None,
    )
