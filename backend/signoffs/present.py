"""What runs of now would be of: the newest definition of each campaign, and what live workers have installed."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from backend.catalog.installation import Installation, installation, no_simulator
from backend.db.engine import chunks
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run
from campaigns import CampaignError
from campaigns.asked.load import load_document
from campaigns.asked.requirements import definition
from campaigns.identity.identity import ENGINE, SIMULATORS, Identity, installed
from campaigns.identity.identity import changes as differing
from campaigns.runs import run_name

NOT_STORED = "its code is not stored, so a change of the model cannot be excluded"


@dataclass(frozen=True)
class Present:
    """newest: run and definition by campaign name."""

    installation: Installation
    newest: Mapping[str, tuple[int, str]]


def counted() -> tuple[sa.ColumnElement[bool], ...]:
    return Run.removed.is_(None), Run.purged.is_(None), ~in_sweep()


def present(reader: sa.Connection, names: Collection[str]) -> Present:
    newest: dict[str, tuple[int, str]] = {}
    for some in chunks(names):
        of = sa.select(sa.func.max(Run.id)).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        last = of.where(CampaignRow.name.in_(some), *counted()).group_by(CampaignRow.name)
        found = sa.select(Run.id, CampaignRow.name, CampaignRow.document)
        found = found.join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(Run.id.in_(last))
        newest |= {row.name: (int(row.id), definition(row.document)) for row in reader.execute(found)}
    return Present(installation(reader), newest)


def changed_campaign(newer: int) -> str:
    """The clause; newer: the run with another definition."""
    return f"its campaign has changed, see {run_name(newer)}"


def changes(now: Present, run_id: int, name: str, document: Mapping[str, Any], then: Identity | None) -> Iterator[str]:
    """What differs between a run and now, as clauses; what is not stored is named, not taken for equal."""
    newer, defined = now.newest.get(name, (run_id, ""))
    if defined and defined != definition(document):
        yield changed_campaign(newer)
    catalogue = now.installation.catalogue
    if catalogue is None:
        yield now.installation.reason
        return
    if then is None:
        yield NOT_STORED
        return
    try:
        campaign = load_document(document, f"the campaign of {run_name(run_id)}")
    except CampaignError:
        yield "this version cannot read its campaign, so a change cannot be excluded"
        return
    here = installed(campaign, catalogue, then)
    yield from (change.text for change in differing(then, here))
    if ENGINE in here.unidentified:
        yield "a part of it is no longer installed"
    if ENGINE in then.unidentified:
        yield NOT_STORED
    absent = {f"{SIMULATORS}/{simulator}" for simulator in now.installation.absent}
    for unread in dict.fromkeys(name for name in then.unidentified + here.unidentified if name != ENGINE):
        alone = unread in absent and unread not in then.unidentified
        yield no_simulator(unread) if alone else f"{unread} is not identified, so a change cannot be excluded"
