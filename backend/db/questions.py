"""The questions that runs ask: the bounds of each, and which of them differ in nothing else."""

from __future__ import annotations

from collections.abc import Collection

import sqlalchemy as sa

from backend.db.engine import chunks, insert
from backend.db.tables import Question, Run
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.box import Box
from campaigns.checked.question import box, question
from campaigns.documents import digest_of


def store(connection: sa.Connection, campaign: Campaign, described: Catalogue | None) -> dict[str, str]:
    """Store the question of a campaign in the caller's transaction; returns what its run states of it, by column."""
    asks, bounds = question(campaign, described), box(campaign, described)
    row = {"question": asks, "kin": bounds.kin, "parts": bounds.document()}
    digest = digest_of(row)
    connection.execute(insert(connection, Question).values(digest=digest, **row).on_conflict_do_nothing())
    return {"question": asks, "bounds": digest}


def alike(reader: sa.Connection, digests: Collection[str]) -> dict[str, str]:
    """These questions and all that differ from one of them only in bounds, each with what they have in common.

    A question that only a worker of an earlier version stored is like no other one.
    """
    found = {digest: digest for digest in digests}
    for some in chunks(digests):
        kins = sa.select(Question.kin).where(Question.question.in_(some))
        of = sa.select(Question.question, Question.kin).where(Question.kin.in_(kins)).distinct()
        found |= {row.question: row.kin for row in reader.execute(of)}
    return found


def boxes(reader: sa.Connection, digests: Collection[str]) -> dict[tuple[str, str], Box]:
    """The boxes with these digests, by question and digest: a worker of an earlier version may store another question
    of a run, and leaves its bounds."""
    found = {}
    for some in chunks(digests):
        for row in reader.execute(sa.select(Question.__table__).where(Question.digest.in_(some))):
            found[row.question, row.digest] = Box.of(row.kin, row.parts)
    return found


def kin(run: type[Run]) -> sa.ColumnElement[str | None]:
    """What the question of a run has in common with those that differ from it only in bounds, as in `alike`."""
    of = sa.select(sa.func.max(Question.kin)).where(Question.question == run.question)
    return sa.func.coalesce(of.correlate(run).scalar_subquery(), run.question)
