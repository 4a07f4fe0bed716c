"""A run's campaign as a file: as it was typed where it came as text, comments and all. Start reading at `text`."""

from __future__ import annotations

import json

import sqlalchemy as sa

from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run, RunText
from backend.runs.service import require
from campaigns import CampaignError
from campaigns.asked.load import load_document
from campaigns.asked.text import to_yaml
from campaigns.runs import run_name


def text(reader: sa.Connection, run_id: int) -> str:
    """The text that a run was submitted as, else its campaign as YAML; 404 for no such run, 410 for a purged one."""
    require(reader, run_id)
    typed = reader.scalar(sa.select(RunText.text).where(RunText.run_id == run_id))
    if typed is not None:
        return str(typed)
    of = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    document = reader.execute(of).scalar_one()
    try:
        return to_yaml(load_document(document, run_name(run_id)))
    except CampaignError:  # of another version: told as it is kept, and refused where it is read
        return json.dumps(document, indent=2)
