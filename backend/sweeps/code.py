"""Whether the runs of a sweep were run by the same code; else differences between its values may come from the code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run, SweepRun
from backend.runs import identity
from campaigns.runs import RunState


def of_sweeps(reader: sa.Connection, sweep_ids: Collection[int]) -> dict[int, Counter[str | None]]:
    """By sweep: how many of its runs that are done have each code, None if it is not identified. Purged runs are
    omitted."""
    of = sa.select(SweepRun.sweep_id, *identity.COLUMNS).join(Run, Run.id == SweepRun.run_id)
    of = of.join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    done = (Run.state == RunState.DONE, Run.purged.is_(None))
    texts = of.where(SweepRun.sweep_id.in_(list(sweep_ids)), *done).subquery()
    found: dict[int, Counter[str | None]] = {sweep_id: Counter() for sweep_id in sweep_ids}
    # Most runs of a sweep have the same texts, so one row stands for them.
    for row in reader.execute(sa.select(texts, sa.func.count().label("runs")).group_by(*texts.c)):
        found[row.sweep_id][identity.with_digest(row)[1]] += row.runs
    return found


def warning(codes: Counter[str | None]) -> str:
    """What a reader has to know of the code of runs that are compared; empty if all have the same."""
    unidentified = codes[None]
    if (different := len(codes.keys() - {None})) > 1:
        return (
            f"The code changed while the sweep ran: {different} codes ran its runs. Differences between the values may "
            "come from the code."
        )
    if not unidentified or codes.total() < 2:
        return ""
    which = "one run is" if unidentified == 1 else f"{unidentified} runs is"
    return f"The code of {which} not identified, so it may differ between the runs."
