"""the bounds of every question, so that a violation within other bounds speaks against it"""

import sqlalchemy as sa
from alembic import op
from pydantic import ValidationError

from campaigns import Catalogue
from campaigns.asked.load import CampaignError, load_document
from campaigns.checked.question import box

revision = "0038"
down_revision = "0037"

_CAMPAIGNS = sa.table("campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON))
_RUNS = sa.table(
    "runs", sa.column("campaign_digest", sa.String), sa.column("snapshot", sa.String), sa.column("question", sa.String)
)
_SNAPSHOTS = sa.table("catalogue_snapshots", sa.column("digest", sa.String), sa.column("document", sa.JSON))
_INSTALLED = sa.table("catalogue", sa.column("document", sa.JSON))
_QUESTIONS = sa.table(
    "questions", sa.column("digest", sa.String), sa.column("kin", sa.String), sa.column("parts", sa.JSON)
)


def upgrade() -> None:
    op.create_table(
        "questions",
        sa.Column("digest", sa.String(64), primary_key=True),
        sa.Column("kin", sa.String(64), nullable=False),
        sa.Column("parts", sa.JSON(), nullable=False),
    )
    op.create_index("ix_questions_kin", "questions", ["kin"])
    connection = op.get_bind()
    installed = _described(connection.scalar(sa.select(_INSTALLED.c.document)))
    snapshots: dict[str | None, Catalogue | None] = {None: installed}
    stored: set[str] = set()
    # In a fixed order: two runs of one question may have had other defaults of what it does not state.
    columns = (_RUNS.c.question, _RUNS.c.campaign_digest, _RUNS.c.snapshot)
    asking = sa.select(*columns).where(_RUNS.c.question.is_not(None)).distinct().order_by(*columns)
    for question, campaign, snapshot in connection.execute(asking).all():
        if question in stored:
            continue
        if snapshot not in snapshots:
            of = sa.select(_SNAPSHOTS.c.document).where(_SNAPSHOTS.c.digest == snapshot)
            snapshots[snapshot] = _described(connection.scalar(of))
        document = connection.scalar(sa.select(_CAMPAIGNS.c.document).where(_CAMPAIGNS.c.digest == campaign))
        try:
            bounds = box(load_document(document), snapshots[snapshot])
        except CampaignError:  # of a version whose campaigns this one cannot read: only an equal question is alike
            continue
        row = {"digest": question, "kin": bounds.kin, "parts": bounds.document()}
        connection.execute(sa.insert(_QUESTIONS).values(**row))
        stored.add(question)


def _described(document: object) -> Catalogue | None:
    try:
        return None if document is None else Catalogue.model_validate(document)
    except ValidationError:
        return None
