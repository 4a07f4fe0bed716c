"""An earlier run that answers the same question: the same campaign and code, with a verdict. Read `reusable`."""

from __future__ import annotations

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db import codes
from backend.db.tables import Run
from backend.runs.components import components
from campaigns import Campaign
from campaigns.identity.code import code_of
from campaigns.runs import RunState, run_name
from campaigns.versions import Versions, short

LOOKED_AT = 20
"""Runs of the campaign that are examined, the newest first."""


def reusable(reader: sa.Connection, campaign: Campaign, sample_seed: int | None = None) -> int | None:
    """The newest run of the campaign that the installed code ran to a verdict; None if there is none.

    Code, descriptions, the operator's own components and the simulator must be the installed ones, as far as workers
    publish them; what is not stored with a run is not taken for equal. Any sample seed will do if none is stated.
    """
    installed, catalogue = code_of(campaign, codes.installed(reader)), published(reader)
    if installed is None or catalogue is None:
        return None
    ended = (Run.state == RunState.DONE, Run.verdict.is_not(None), Run.removed.is_(None), Run.purged.is_(None))
    query = sa.select(Run.id, Run.flown).where(Run.campaign_digest == campaign.digest, *ended)
    if sample_seed is not None:
        query = query.where(Run.sample_seed == sample_seed)
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
