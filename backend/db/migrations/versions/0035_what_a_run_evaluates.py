"""the question of every run: what it evaluates within which bounds, however its campaign states it"""

import sqlalchemy as sa
from alembic import op
from pydantic import ValidationError

from campaigns import Catalogue
from campaigns.asked.load import CampaignError, load_document
from campaigns.checked.question import question

revision = "0035"
down_revision = "0034"

_CAMPAIGNS = sa.table(
    "campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON), sa.column("question", sa.String)
)
_RUNS = sa.table(
    "runs", sa.column("campaign_digest", sa.String), sa.column("snapshot", sa.String), sa.column("question", sa.String)
)
_SNAPSHOTS = sa.table("catalogue_snapshots", sa.column("digest", sa.String), sa.column("document", sa.JSON))
_INSTALLED = sa.table("catalogue", sa.column("document", sa.JSON))


def upgrade() -> None:
    if op.get_bind().dialect.name == "postgresql":
        # In the order of a submission, which a service of the version before may still accept.
        op.execute("lock table campaigns, runs, run_requirements in access exclusive mode")
    op.add_column("runs", sa.Column("question", sa.String(64), nullable=True))
    op.create_index("ix_runs_question", "runs", ["question"])
    _fill(op.get_bind())
    op.drop_index("ix_campaigns_question", "campaigns")
    op.drop_column("campaigns", "question")
    op.drop_column("run_requirements", "question")


def _fill(connection: sa.Connection) -> None:
    # A run without descriptions, purged or of an early version, asks what it would ask of what is installed.
    installed = _described(connection.scalar(sa.select(_INSTALLED.c.document)))
    snapshots: dict[str | None, Catalogue | None] = {None: installed}
    pairs = sa.select(_RUNS.c.campaign_digest, _RUNS.c.snapshot).distinct()
    for digest, snapshot in connection.execute(pairs).all():
        if snapshot not in snapshots:
            of = sa.select(_SNAPSHOTS.c.document).where(_SNAPSHOTS.c.digest == snapshot)
            snapshots[snapshot] = _described(connection.scalar(of))
        document, before = connection.execute(
            sa.select(_CAMPAIGNS.c.document, _CAMPAIGNS.c.question).where(_CAMPAIGNS.c.digest == digest)
        ).one()
        try:
            asked = question(load_document(document), snapshots[snapshot])
        except CampaignError:  # of a version whose campaigns this one cannot read, and cannot run either
            asked = before
        mine = (_RUNS.c.campaign_digest == digest, _RUNS.c.snapshot.is_not_distinct_from(snapshot))
        connection.execute(sa.update(_RUNS).where(*mine).values(question=asked))


def _described(document: object) -> Catalogue | None:
    try:
        return None if document is None else Catalogue.model_validate(document)
    except ValidationError:
        return None
