"""Other runs with the same input: the same campaign, or one that differs in the seed alone. Read `related`."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run
from backend.runs.outcomes import CODE, Outcome, outcomes
from backend.runs.service import require
from backend.trends.schemas import Difference, RelatedRun, RelatedRuns
from campaigns.results.verdict import VerdictWord

MOST = 50
"""Runs that are listed; all are counted."""


def related(reader: sa.Connection, run_id: int) -> RelatedRuns:
    """Runs of the same campaign with any code, and with another seed of the same or an unknown code.

    Removed runs are omitted. 404 if there is no such run, 410 if it was purged.
    """
    require(reader, run_id)
    (own,) = outcomes(reader, [Run.id == run_id])
    same = Run.campaign_digest == own.campaign_digest
    conditions = [Run.id != run_id, Run.removed.is_(None), sa.or_(same, _other_seed(reader, own))]
    found = outcomes(reader, conditions, MOST)
    total = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(Run.purged.is_(None), *conditions)) or 0
    return RelatedRuns(
        runs=[_related(own, other) for other in found], total=total, question=asked_again(reader, run_id)
    )


def asked_again(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """How many runs ask the question of this one, by verdict: whoever repeats it until it is cleared is seen."""
    own = sa.select(CampaignRow.question).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    same = sa.select(CampaignRow.digest).where(CampaignRow.question == own.scalar_subquery())
    verdict = sa.func.coalesce(Run.verdict, "none")
    of = sa.select(verdict, sa.func.count()).where(Run.campaign_digest.in_(same)).group_by(verdict)
    found = dict(reader.execute(of).tuples().all())
    return {word: found[word] for word in (*VerdictWord, "none") if word in found}


def _other_seed(reader: sa.Connection, own: Outcome) -> sa.ColumnElement[bool]:
    """Campaigns that differ in the seed alone, without runs whose code is known to differ as well."""
    seedless = reader.scalar(sa.select(CampaignRow.seedless).where(CampaignRow.digest == own.campaign_digest))
    if seedless is None:
        return sa.false()
    others = sa.select(CampaignRow.digest).where(
        CampaignRow.seedless == seedless, CampaignRow.digest != own.campaign_digest
    )
    code = sa.true() if own.code is None else sa.or_(CODE.is_(None), own.code == CODE)
    return sa.and_(Run.campaign_digest.in_(others), code)


def _related(own: Outcome, other: Outcome) -> RelatedRun:
    known = own.code is not None and other.code is not None
    differs: list[Difference] = []
    if other.campaign_digest != own.campaign_digest:
        differs.append("seed")
    if known and other.code != own.code:
        differs.append("code")
    return RelatedRun(**dict(other), differs=differs, code_known=known)
