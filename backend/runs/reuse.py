"""An earlier run that answers the same question: the same campaign and code, with a verdict. Read `reusable`."""

from __future__ import annotations

import asyncio
import time

import sqlalchemy as sa
from fastapi.concurrency import run_in_threadpool

from backend.catalog.service import published
from backend.db import workers
from backend.db.engine import ask, now, read
from backend.db.tables import Run
from backend.http.errors import RefusedError
from backend.runs import earlier_rules, identity
from backend.runs.components import components
from backend.runs.violations import LISTED, against
from campaigns import Campaign
from campaigns.identity.identity import UNSTORED, same
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState, run_name
from campaigns.versions import Versions, short

LOOKED_AT = 20
"""Runs of the campaign that are examined: those that violate first, then the newest."""
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
        at = await run_in_threadpool(ask, engine, lambda reader: workers.compared(reader, simulator))
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


def reusable(reader: sa.Connection, campaign: Campaign, sample_seed: int | None = None) -> int | None:
    """The newest run of the campaign that the installed code ran to a verdict; None if there is none.

    Its identity and its descriptions must be the installed ones, as far as workers publish them; what is not
    identified is not taken for equal. Any sample seed will do if none is stated. A run that violates comes before all
    newer ones, which missed a case that exists; of others none is reused if any run speaks against it, also one of
    another seed, budget or sample, or without a verdict. What earlier rules cleared is not reused.
    """
    usable = [Run.campaign_digest == campaign.digest, Run.state == RunState.DONE, Run.verdict.is_not(None)]
    usable += [*LISTED, earlier_rules.TODAY]
    if sample_seed is not None:
        usable.append(Run.sample_seed == sample_seed)
    first = sa.case((Run.verdict == VerdictWord.VIOLATED, 0), else_=1)
    query = sa.select(Run.id, Run.flown).where(*usable).order_by(first, Run.id.desc()).limit(LOOKED_AT)
    for run_id, flown in reader.execute(query).all():
        then = identity.of_run(reader, run_id)
        now = None if then is None else identity.of_installed(reader, campaign, then)
        if then is None or now is None or not same(then, now) or Versions.of(flown).command:
            continue
        try:
            descriptions = components(reader, run_id)
        except RefusedError:  # another version stored them
            continue
        if descriptions.digest is not None and not descriptions.changes:
            return None if against(reader, [run_id]) else int(run_id)
    return None


def sentence(reader: sa.Connection, run_id: int) -> str:
    name = run_name(run_id)
    campaign = reader.scalar(sa.select(Run.campaign_digest).where(Run.id == run_id)) or ""
    then = identity.of_run(reader, run_id) or UNSTORED
    own = "".join(f", {file} {short(digest)}" for file, digest in then.files.items())
    return (
        f"{name} is reused: it has a verdict on the same campaign (sha256 {short(campaign)}) by the same code (sha256 "
        f"{short(then.digest or '')}{own}) and packages. Machines are not compared, and the labels are those of {name}."
    )
