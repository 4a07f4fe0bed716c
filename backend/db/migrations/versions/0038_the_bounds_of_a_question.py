"""the bounds of every question, so that a violation within other bounds speaks against it"""

import sqlalchemy as sa
from alembic import op
from pydantic import ValidationError

from campaigns import Catalogue
from campaigns.asked.load import CampaignError, load_document
from campaigns.checked.question import box
from campaigns.documents import digest_of

revision = "0038"
down_revision = "0037"

_CAMPAIGNS = sa.table("campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON))
_RUNS = sa.table(
    "runs", *(sa.column(name, sa.String) for name in ("campaign_digest", "snapshot", "question", "bounds"))
)
_SNAPSHOTS = sa.table("catalogue_snapshots", sa.column("digest", sa.String), sa.column("document", sa.JSON))
_INSTALLED = sa.table("catalogue", sa.column("document", sa.JSON))
_QUESTIONS = sa.table(
    "questions", *(sa.column(name, sa.String) for name in ("digest", "question", "kin")), sa.column("parts", sa.JSON)
)


def upgrade() -> None:
    op.create_table(
        "questions",
        sa.Column("digest", sa.String(64), primary_key=True),
        sa.Column("question", sa.String(64), nullable=False),
        sa.Column("kin", sa.String(64), nullable=False),
        sa.Column("parts", sa.JSON(), nullable=False),
    )
    op.create_index("ix_questions_question", "questions", ["question"])
    op.create_index("ix_questions_kin", "questions", ["kin"])
    op.add_column("runs", sa.Column("bounds", sa.String(64), nullable=True))
    connection = op.get_bind()
    installed = _described(connection.scalar(sa.select(_INSTALLED.c.document)))
    snapshots: dict[str | None, Catalogue | None] = {None: installed}
    stored: set[str] = set()
    columns = (_RUNS.c.question, _RUNS.c.campaign_digest, _RUNS.c.snapshot)
    asking = sa.select(*columns).where(_RUNS.c.question.is_not(None)).distinct()
    for question, campaign, snapshot in connection.execute(asking).all():
        if snapshot not in snapshots:
            of = sa.select(_SNAPSHOTS.c.document).where(_SNAPSHOTS.c.digest == snapshot)
            snapshots[snapshot] = _described(connection.scalar(of))
        document = connection.scalar(sa.select(_CAMPAIGNS.c.document).where(_CAMPAIGNS.c.digest == campaign))
        try:
            bounds = box(load_document(document), snapshots[snapshot])
        except CampaignError:  # of a version whose campaigns this one cannot read: only an equal question is alike
            continue
        row = {"question": question, "kin": bounds.kin, "parts": bounds.document()}
        if (digest := digest_of(row)) not in stored:
            connection.execute(sa.insert(_QUESTIONS).values(digest=digest, **row))
            stored.add(digest)
        mine = sa.and_(_RUNS.c.question == question, _RUNS.c.campaign_digest == campaign)
        mine = sa.and_(mine, _RUNS.c.snapshot.is_not_distinct_from(snapshot))
        connection.execute(sa.update(_RUNS).where(mine).values(bounds=digest))


def _described(document: object) -> Catalogue | None:
    try:
        return None if document is None else Catalogue.model_validate(document)
    except ValidationError:
        return None
