"""Audits a run created by a test, in any form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Set
from pathlib import Path
from typing import Any

import numpy as np
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.rows import plain
from campaigns import Campaign
from campaigns.checked.snapshot import snapshot
from campaigns.results import Verdict
from clearance.local.likelihood import Likelihoods
from clearance.local.results import evidence
from clearance.local.summary import summary
from worker.engine.stages.parts import offered
from worker.evidence.audit.judge import Item, audit, closing
from worker.evidence.audit.record import Record, exclusions, flaky, of_database, of_folder
from worker.running.catalogue.installed import catalogue
from worker.running.runs.audited import known
from worker.running.runs.store import MemoryStore


def audited(
    run: MemoryStore | Path | sa.Engine,
    campaign: Campaign | None = None,
    run_id: int = 1,
    lacks: Set[str] = frozenset(),
) -> list[Item]:
    """Fail unless the verdict follows, with every item audited: of a run in memory, with its campaign; in a folder; or
    in a database, by its number. lacks: what the version that stored it did not state. A simulator of the test alone is
    compared with no installed one."""
    record = recorded(run, campaign, run_id)
    items = audit(record, known(record), offered.AT_MOST, offered.SPOT_CHECKS)
    follows, statement = closing(items)
    assert follows, statement + "".join(f"\n{i.name}: {i.given} / {i.recomputed}" for i in items if i.agrees is False)
    compared = {item.name for item in items if item.name != "components" or not record.campaign.simulator}
    assert {item.name for item in items if not item.agrees} & compared == lacks, statement
    return items


def audited_summary(
    campaign: Campaign, store: MemoryStore, verdict: Verdict, likely: Likelihoods | None = None
) -> dict[str, Any]:
    """What `clearance run` prints of a run, which is audited first."""
    audited(store, campaign)
    return summary(campaign, store, verdict, likely)


def recorded(run: MemoryStore | Path | sa.Engine, campaign: Campaign | None = None, run_id: int = 1) -> Record:
    """A run as the audit reads it."""
    if isinstance(run, Path):
        return of_folder(run)
    if isinstance(run, sa.Engine):
        with read(run) as connection:
            return of_database(connection, run_id)
    assert campaign is not None
    assert run.verdict is not None
    held = {k: columns for k in range(len(run.stages)) if (columns := run.evaluations(k)) is not None}
    claims = plain(summary(campaign, run, run.verdict) | evidence(campaign, run))
    claims |= {"components": snapshot(campaign, catalogue())}
    stage = np.repeat(list(held), [len(c.status) for c in held.values()])
    again = sum(flaky(c.status, c.reasons) for c in held.values())
    points, costs, status = (
        np.concatenate([getattr(c, name) for c in held.values()]) for name in ("points", "costs", "status")
    )
    left_out = sum((exclusions(c.status, c.reasons) for c in held.values()), Counter[str]())
    twice = {"digests.result": (claims["digest"], campaign.digest)}
    return Record(campaign, claims, twice, stage, points, costs, status, again, left_out)
