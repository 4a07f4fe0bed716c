"""The questions that runs ask: the bounds of each, and which of them differ in nothing else."""

from __future__ import annotations

from collections.abc import Collection

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.engine import chunks, insert
from backend.db.tables import Question
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.box import Box
from campaigns.checked.question import box, question

Column = orm.InstrumentedAttribute[str | None]


def store(connection: sa.Connection, campaign: Campaign, described: Catalogue | None) -> str:
    """Store the question of a campaign in the caller's transaction; returns its digest."""
    digest, bounds = question(campaign, described), box(campaign, described)
    row = {"digest": digest, "kin": bounds.kin, "parts": bounds.document()}
    connection.execute(insert(connection, Question).values(**row).on_conflict_do_nothing())
    return digest


def alike(reader: sa.Connection, digests: Collection[str]) -> dict[str, str]:
    """These questions and all that differ from one of them only in bounds, each with what they have in common.

    A question that a worker of an earlier version stored is like no other one.
    """
    found = {digest: digest for digest in digests}
    for some in chunks(digests):
        kins = sa.select(Question.kin).where(Question.digest.in_(some))
        of = sa.select(Question.digest, Question.kin).where(Question.kin.in_(kins))
        found |= {row.digest: row.kin for row in reader.execute(of)}
    return found


def boxes(reader: sa.Connection, digests: Collection[str]) -> dict[str, Box]:
    """The boxes of these questions, by digest."""
    found = {}
    for some in chunks(digests):
        for row in reader.execute(sa.select(Question.__table__).where(Question.digest.in_(some))):
            found[row.digest] = Box.of(row.kin, row.parts)
    return found


def asks_alike(one: Column, other: Column) -> sa.ColumnElement[bool]:
    """Whether a question equals another one, or differs from it only in bounds."""
    mine, theirs = orm.aliased(Question), orm.aliased(Question)
    of = sa.select(theirs.digest).join(mine, mine.kin == theirs.kin).where(mine.digest == other)
    return sa.or_(one == other, one.in_(of))
