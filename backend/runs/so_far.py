"""What a sample shows while it is drawn, of which only the lowest evaluations are stored."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from pydantic import ValidationError

from backend.catalog.service import bounds, described
from backend.db.tables import CampaignRow, Run, Stage
from backend.runs import sampled
from campaigns import Campaign
from campaigns.asked.distributions import Normal
from campaigns.claims.stages.sample import STATED_SEED, Drawn, so_far
from campaigns.densities.joint import joint
from campaigns.results.remedies import bound
from campaigns.results.sample import SoFar
from campaigns.runs import StageState


def of_run(reader: sa.Connection, run_id: int) -> dict[int, SoFar]:
    """By the position of the stage; none for a run without such a sample, once it is whole, or if its campaign or
    descriptions were stored by another version."""
    drawing = (Stage.run_id == run_id, Stage.counted > 0, Stage.state == StageState.RUNNING)
    columns = (Stage.position, Stage.planned, Stage.counted, Stage.excluded, Stage.violations)
    rows = reader.execute(sa.select(*columns).where(*drawing)).all()
    if not rows:
        return {}
    of = sa.select(CampaignRow.document, sampled.STATED.label("stated"))
    run = reader.execute(of.join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)).one()
    seed = STATED_SEED if run.stated else ""
    try:
        campaign = Campaign.model_validate(run.document)
        outside = _outside(reader, run_id, campaign)
    except ValidationError:
        return {}
    return {row.position: _shown(row, campaign.confidence, outside, seed) for row in rows if row.counted > row.excluded}


def _outside(reader: sa.Connection, run_id: int, campaign: Campaign) -> float | None:
    """The probability beyond the bounds, which is part of the bound; None if the bounds are not known here."""
    if not any(isinstance(one.distribution, Normal) for one in campaign.uncertain.values()):
        return 0.0
    known = {path: (low, high) for path, (_, low, high) in bounds(campaign, described(reader, run_id)).items()}
    return joint(campaign, known).outside if known.keys() >= campaign.uncertain.keys() else None


def _shown(row: Any, confidence: float, outside: float | None, seed: str) -> SoFar:
    samples = row.counted - row.excluded
    whole, beyond = max(row.planned, samples), outside or 0.0
    now, end = (min(1.0, bound(row.violations, size, confidence) + beyond) for size in (samples, whole))
    drawn = Drawn(row.violations, samples, confidence, outside, row.excluded, seed)
    return SoFar(
        samples=samples,
        violations=row.violations,
        upper_bound=now,
        at_end=end,
        within_bounds=outside is None,
        statement=so_far(drawn, now, whole - samples, end),
    )
