"""What the runs of one user may occupy: the queue, and stored evaluations. Start reading at `refuse_beyond`."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.access import Visitor
from backend.db.tables import Run, Token
from backend.http.errors import RefusedError

ACTIVE = ("queued", "running", "cancelling")


@dataclass(frozen=True)
class Quota:
    """The limits of one user, tokens included."""

    active: int
    """Runs that have not ended."""
    evaluations: int
    """Stored evaluations of all runs but purged ones."""


def refuse_beyond(reader: sa.Connection, quota: Quota, visitor: Visitor, more: int = 1) -> None:
    """Raise 409 unless the visitor's account may queue so many more runs."""
    tokens = sa.select(Token.name).where(Token.owner == visitor.account)
    mine = sa.or_(Run.owner == visitor.account, Run.owner.in_(tokens))
    active = reader.scalar(sa.select(sa.func.count()).select_from(Run).where(mine, Run.state.in_(ACTIVE))) or 0
    if active + more > quota.active:
        raise RefusedError(
            409,
            "quota-reached",
            f"{visitor.account} has {active:,} runs that have not ended, and {more:,} more would exceed the limit of "
            f"{quota.active:,} for one user: wait for some to end, or cancel some",
        )
    stored = reader.scalar(sa.select(sa.func.sum(Run.evaluations)).where(mine, Run.purged.is_(None))) or 0
    if stored >= quota.evaluations:
        raise RefusedError(
            409,
            "quota-reached",
            f"the runs of {visitor.account} have {stored:,} stored evaluations, and the limit for one user is "
            f"{quota.evaluations:,}: have an administrator remove and purge some (`clearance purge`), or raise "
            "CLEARANCE_MAX_EVALUATIONS_EACH",
        )
