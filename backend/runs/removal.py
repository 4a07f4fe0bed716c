"""Removal of runs from all lists, and restoration. Nothing is deleted here; that is done by `clearance purge`.

A removed run retains its address, its results and its history.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sqlalchemy as sa

from backend.db import audit
from backend.db.access import Visitor
from backend.db.engine import now
from backend.db.signed import signer
from backend.db.tables import Run, Signoff
from backend.http.errors import RefusedError, not_found
from backend.runs import listing, tombstones
from backend.runs.schemas import RunSummary
from campaigns import Problem
from campaigns.runs import ENDED, run_name

Unchanged = Callable[[sa.Connection], None]


def remove(
    engine: sa.Engine, run_ids: Sequence[int], reason: str, visitor: Visitor, unchanged: Unchanged | None = None
) -> list[RunSummary]:
    """Remove runs from the lists, all of them or none; runs that are already removed are unchanged.

    404 for an unknown run, 410 for a purged one, 409 for one that is active or has a valid sign-off. unchanged: raises
    412 if the runs have changed.
    """
    with engine.begin() as writer:
        rows = _locked(writer, run_ids)
        if unchanged is not None:
            unchanged(writer)
        _refuse(_standing(writer, rows))
        values = {"removed": now(writer), "removed_by": visitor.user, "removed_reason": reason}
        listed = [row for row in rows if row.removed is None]
        writer.execute(sa.update(Run).where(Run.id.in_([row.id for row in listed])).values(**values))
        for row in listed:
            audit.note(writer, visitor, "run.removed", run_name(row.id), {"reason": reason})
    return listing.named(engine, run_ids)


def restore(engine: sa.Engine, run_ids: Sequence[int], visitor: Visitor) -> list[RunSummary]:
    """Restore runs to the lists; listed ones are unchanged. 404 for an unknown run, 410 for a purged one."""
    with engine.begin() as writer:
        removed = [row for row in _locked(writer, run_ids) if row.removed is not None]
        values = dict.fromkeys(("removed", "removed_by", "removed_reason"))
        writer.execute(sa.update(Run).where(Run.id.in_([row.id for row in removed])).values(**values))
        for row in removed:
            detail = {"removed_by": row.removed_by, "reason": row.removed_reason}
            audit.note(writer, visitor, "run.restored", run_name(row.id), detail)
    return listing.named(engine, run_ids)


def refuse_removed(writer: sa.Connection, run_id: int) -> None:
    """Raise 409 if the run is removed, 410 if it was purged. Locks its row, so that neither can happen concurrently."""
    removed = writer.scalar(sa.select(Run.removed).where(Run.id == run_id).with_for_update())
    tombstones.refuse_purged(writer, run_id)
    if removed is not None:
        raise RefusedError("removed", f"{run_name(run_id)} is removed: restore it first")


def _locked(writer: sa.Connection, run_ids: Sequence[int]) -> list[Any]:
    """The runs' rows, locked in the order of their numbers, which prevents deadlocks between removals."""
    columns = (Run.id, Run.state, Run.removed, Run.removed_by, Run.removed_reason)
    of = sa.select(*columns).where(Run.id.in_(run_ids)).order_by(Run.id).with_for_update()
    rows = {row.id: row for row in writer.execute(of)}
    for run_id in run_ids:
        if run_id not in rows:
            raise not_found("run", run_name(run_id))
        tombstones.refuse_purged(writer, run_id)
    return list(rows.values())


def _standing(writer: sa.Connection, rows: Sequence[Any]) -> list[Problem]:
    ids = [row.id for row in rows if row.removed is None]
    of = sa.select(Signoff.run_id, Signoff.account, Signoff.name).where(
        Signoff.run_id.in_(ids), Signoff.withdrawn.is_(None)
    )
    signed = {row.run_id: signer(row.account, row.name).name for row in writer.execute(of.order_by(Signoff.id.desc()))}
    found = []
    for row in rows:
        run = run_name(row.id)
        if row.state not in ENDED:
            found.append(Problem("run", run, f"it is {row.state}: cancel it first, or wait for it to end"))
        elif row.id in signed:
            text = f"its results are signed off by {signed[row.id]}: withdraw the sign-off first"
            found.append(Problem("run", run, text))
    return found


def _refuse(problems: Sequence[Problem]) -> None:
    if problems:
        refused = "; ".join(f"{p.given} cannot be removed, {p.message}" for p in problems[:3])
        more = f"; and {len(problems) - 3} more" if len(problems) > 3 else ""
        none = ". None was removed" if len(problems) > 1 else ""
        raise RefusedError("not-removable", refused + more + none, problems)
