"""A run's campaign as a file: the original text with its comments, if it was submitted as text.

The baseline is not part of it: it is added at launch.
"""

from __future__ import annotations

import json
import re

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run, RunText
from backend.runs.service import require
from campaigns import CampaignError
from campaigns.asked.load import load_document
from campaigns.asked.text import to_yaml
from campaigns.runs import run_name

MODELINE = "# yaml-language-server: $schema="
SCHEMA = "/api/v1/campaigns/schema"
_OURS = re.compile(rf"{re.escape(MODELINE)}\S*{re.escape(SCHEMA)}\r?\n")


def with_schema(text: str, service: str) -> str:
    """YAML that names the schema with which editors complete and check it; JSON, and another schema, stay as they are.

    service: its address. A comment changes no digest.
    """
    own = _OURS.match(text)
    rest = text[own.end() :] if own else text.removeprefix("\ufeff")
    if rest.lstrip().startswith("{") or (not own and rest.startswith("# yaml-language-server:")):
        return text
    return f"{MODELINE}{service}{SCHEMA}\n{rest}"


def text(reader: sa.Connection, run_id: int) -> str:
    """The original text of a run's campaign, else YAML; 404 if there is no such run, 410 if it was purged."""
    require(reader, run_id)
    typed = reader.scalar(sa.select(RunText.text).where(RunText.run_id == run_id))
    if typed is not None:
        return str(typed)
    of = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest).where(Run.id == run_id)
    document = reader.execute(of).scalar_one()
    try:
        return to_yaml(load_document(document, run_name(run_id)).model_copy(update={"baseline": None}))
    except CampaignError:  # stored by another version: returned unchanged, although this version cannot parse it
        return json.dumps(document, indent=2)
