"""What a sample shows while it is drawn, of which only the lowest evaluations are stored."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run, Stage
from campaigns.claims.stages.sample import Drawn, so_far
from campaigns.limits import CONFIDENCE
from campaigns.results.remedies import bound
from campaigns.results.sample import SoFar
from campaigns.runs import StageState


def of_run(reader: sa.Connection, run_id: int) -> dict[int, SoFar]:
    """By the position of the stage; none for a run without such a sample, or once it is whole."""
    drawing = (Stage.run_id == run_id, Stage.counted > 0, Stage.state == StageState.RUNNING)
    columns = (Stage.position, Stage.planned, Stage.counted, Stage.excluded, Stage.violations)
    rows = reader.execute(sa.select(*columns).where(*drawing)).all()
    if not rows:
        return {}
    of = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    document = reader.execute(of).scalar_one()
    confidence = float(document.get("confidence", CONFIDENCE))
    # What lies beyond the bounds is part of the bound of the stage; here it is left out, and said to be.
    beyond = any((u.get("distribution") or {}).get("kind") == "normal" for u in document["uncertain"].values())
    return {row.position: _shown(row, confidence, beyond) for row in rows if row.counted > row.excluded}


def _shown(row: Any, confidence: float, beyond: bool) -> SoFar:
    samples = row.counted - row.excluded
    whole = max(row.planned, samples)
    now, end = (bound(row.violations, size, confidence) for size in (samples, whole))
    drawn = Drawn(row.violations, samples, confidence, beyond)
    statement = so_far(drawn, now, whole - samples, end)
    return SoFar(samples=samples, violations=row.violations, upper_bound=now, at_end=end, statement=statement)
