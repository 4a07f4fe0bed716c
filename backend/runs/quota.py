"""What the runs of one user may occupy: the queue, stored evaluations, space."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.db import users
from backend.db.access import Visitor
from backend.db.tables import Run, Stage
from backend.http.errors import RefusedError
from campaigns.runs import ACTIVE


@dataclass(frozen=True)
class Quota:
    """The limits of one user, tokens included."""

    active: int
    """Runs that have not ended."""
    evaluations: int
    """Stored evaluations of all runs but purged ones."""
    size: int
    """What all runs but purged ones store [bytes]."""


def refuse_beyond(writer: sa.Connection, quota: Quota, visitor: Visitor, more: int = 1) -> None:
    """Raise 409 unless the visitor's account may queue so many more runs, and let it queue no others meanwhile."""
    users.hold(writer, visitor.account)
    mine = Run.owner == visitor.account
    active = writer.scalar(sa.select(sa.func.count()).select_from(Run).where(mine, Run.state.in_(ACTIVE))) or 0
    if active + more > quota.active:
        noun = "run that has" if active == 1 else "runs that have"
        raise RefusedError(
            "quota-reached",
            f"{visitor.account} has {active:,} {noun} not ended, and {more:,} more would exceed the limit of "
            f"{quota.active:,} for one user: wait for some to end, or cancel some",
        )
    kept = (mine, Run.purged.is_(None))
    sums = sa.select(sa.func.sum(Run.evaluations), sa.func.sum(Run.size)).where(*kept)
    made, size = (int(value or 0) for value in writer.execute(sums).one())
    counted = sa.select(sa.func.sum(Stage.counted)).join(Run, Run.id == Stage.run_id).where(*kept)
    stored = made - int(writer.scalar(counted) or 0)
    for what, used, most, setting in (
        ("stored evaluations", stored, quota.evaluations, "CLEARANCE_MAX_EVALUATIONS_EACH"),
        ("bytes of campaigns, evaluations and trajectories", size, quota.size, "CLEARANCE_MAX_BYTES_EACH"),
    ):
        if used >= most:
            raise RefusedError(
                "quota-reached",
                f"the runs of {visitor.account} have {used:,} {what}, and the limit for one user is {most:,}: have an "
                f"administrator remove and purge some (`clearance purge`), or raise {setting}",
            )
