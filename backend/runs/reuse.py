"""An earlier run that answers the same question: the same campaign and code, with a verdict. Read `reusable`."""

from __future__ import annotations

import asyncio
import time

import sqlalchemy as sa
from fastapi.concurrency import run_in_threadpool

from backend.catalog.service import published
from backend.db import codes, workers
from backend.db.engine import now, read
from backend.db.tables import Run
from backend.runs.components import components
from campaigns import Campaign
from campaigns.identity.code import code_of
from campaigns.runs import RunState, run_name
from campaigns.versions import Versions, short

LOOKED_AT = 20
"""Runs of the campaign that are examined, the newest first."""
PATIENCE = 10.0
"""Time for the workers to compare their files with what they have published [s]; an idle one needs about 2 s."""
PAUSE = 0.05
"""Time between two looks at what they have compared [s]."""


async def compared(engine: sa.Engine, campaign: Campaign, baseline: bool) -> bool:
    """Wait until every worker that may run the campaign has compared its files with what it has published since now.

    A file may have been edited a moment ago. False if no worker is there, or one does not answer; then nothing may be
    reused. baseline: whether one is added to the campaign.
    """
    since, simulator = await run_in_threadpool(_candidate, engine, campaign, baseline)
    deadline = time.monotonic() + PATIENCE
    while since is not None and time.monotonic() < deadline:
        at = await run_in_threadpool(_compared, engine, simulator)
        if at is None or at >= since:
            return at is not None
        await asyncio.sleep(PAUSE)
    return False


def _candidate(engine: sa.Engine, campaign: Campaign, baseline: bool) -> tuple[float | None, str | None]:
    """The time now, None if nothing can be reused; and the simulator as its workers have it."""
    with read(engine) as reader:
        since, catalogue = now(reader), published(reader)
        if catalogue is None or not (baseline or reusable(reader, campaign) is not None):
            return None, None
    entry = None if campaign.simulator is None else catalogue.simulator(campaign.simulator.name)
    return since, None if entry is None else entry.version


def _compared(engine: sa.Engine, simulator: str | None) -> float | None:
    with read(engine) as reader:
        return workers.compared(reader, simulator)


def reusable(reader: sa.Connection, campaign: Campaign) -> int | None:
    """The newest run of the campaign that the installed code ran to a verdict; None if there is none.

    Code, descriptions, the operator's own components and the simulator must be the installed ones, as far as workers
    publish them; what is not stored with a run is not taken for equal.
    """
    installed, catalogue = code_of(campaign, codes.installed(reader)), published(reader)
    if installed is None or catalogue is None:
        return None
    ended = (Run.state == RunState.DONE, Run.verdict.is_not(None), Run.removed.is_(None), Run.purged.is_(None))
    query = sa.select(Run.id, Run.flown).where(Run.campaign_digest == campaign.digest, *ended)
    for run_id, flown in reader.execute(query.order_by(Run.id.desc()).limit(LOOKED_AT)).all():
        versions = Versions.of(flown)
        if versions.code != installed or versions.command:
            continue
        if campaign.simulator is not None and (
            not versions.simulator or catalogue.digests.get(campaign.simulator.name) != versions.simulator
        ):
            continue
        descriptions = components(reader, run_id)
        if descriptions.digest is None or descriptions.changes or descriptions.code_changes:
            continue
        return int(run_id)
    return None


def sentence(reader: sa.Connection, run_id: int) -> str:
    name = run_name(run_id)
    campaign, flown = reader.execute(sa.select(Run.campaign_digest, Run.flown).where(Run.id == run_id)).one()
    code = Versions.of(flown).code or ""
    return (
        f"{name} is reused: it has a verdict on the same campaign (sha256 {short(campaign)}) by the same code (sha256 "
        f"{short(code)}). Package versions and machine are not compared, and the labels are those of {name}."
    )
