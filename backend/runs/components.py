"""The description of a run's components, and its differences from this installation."""

from __future__ import annotations

from functools import partial

import sqlalchemy as sa

from backend.catalog.service import published, required, snapshot_of
from backend.db import codes
from backend.db.tables import Run
from backend.runs import identity, service
from backend.runs.schemas import RunComponents
from campaigns import Catalogue
from campaigns.checked.snapshot import changes, snapshot
from campaigns.identity.identity import ENGINE, UNSTORED, Identity
from campaigns.identity.identity import changes as differing


def components(reader: sa.Connection, run_id: int) -> RunComponents:
    """The descriptions stored with the run, or the installed ones if nothing was stored. 404 if there is no such
    run."""
    campaign = service.campaign(reader, run_id)
    kept = snapshot_of(reader, run_id)
    digest = reader.scalar(sa.select(Run.snapshot).where(Run.id == run_id))
    then = identity.of_run(reader, run_id) or UNSTORED
    now = identity.of_installed(reader, campaign, then)
    described = partial(
        RunComponents,
        code=then.digest,
        code_installed=None if now is None else now.digest,
        code_changes=[] if now is None else _changed(reader, then, now),
        unidentified=list(dict.fromkeys(then.unidentified + (() if now is None else now.unidentified))),
    )
    if kept is None:
        return described(digest=None, catalogue=snapshot(campaign, required(reader)), changes=[])
    return described(digest=digest, catalogue=kept, changes=changed(kept, published(reader)))


def _changed(reader: sa.Connection, then: Identity, now: Identity) -> list[str]:
    """What has changed since the run; of the engine the modules that the newest worker has otherwise."""
    found = identity.names(differing(then, now))
    modules = codes.changed(reader, then.engine) if ENGINE in found else []
    return [*(name for name in found if name != ENGINE or not modules), *modules]


def changed(kept: Catalogue, installed: Catalogue | None) -> list[str]:
    if installed is None:
        return []
    return [f"{clause[0].upper()}{clause[1:]}." for clause in changes(kept, installed)]
