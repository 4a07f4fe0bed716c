"""What the campaigns of runs state requirements to be; for the queue."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import RunRequirement
from campaigns.asked.requirements import question
from campaigns.asked.spec import Campaign


def store(writer: sa.Connection, run_id: int, campaign: Campaign) -> None:
    stated = campaign.criterion.requirements
    if stated:
        asked = question(campaign.document())
        rows = [{"requirement": one.id, "text": one.text, "run_id": run_id, "question": asked} for one in stated]
        writer.execute(sa.insert(RunRequirement), rows)
