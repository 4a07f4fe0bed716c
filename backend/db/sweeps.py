"""Which runs are variants of a sweep. They are of other values than the campaign they were made from."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Run, SweepRun


def _variants() -> sa.CTE:
    """The runs of sweeps with those that they continue, which give them their place, and those that extend them."""
    before, after = sa.select(Run.continues, Run.id), sa.select(Run.id, Run.continues)
    links = sa.union_all(*(of.where(Run.continues.is_not(None)) for of in (before, after))).subquery()
    one, other = links.c
    found = sa.select(SweepRun.run_id.label("id")).cte("variants", recursive=True)
    return found.union(sa.select(one).join(found, other == found.c.id))


_VARIANTS = _variants()


def in_sweep() -> sa.ColumnElement[bool]:
    return Run.id.in_(sa.select(_VARIANTS.c.id))
