"""The description of a run's components, and its differences from this installation."""

from __future__ import annotations

from functools import partial

import sqlalchemy as sa

from backend.catalog.service import published, required
from backend.db import codes, snapshots
from backend.db.tables import Run
from backend.runs import service
from backend.runs.schemas import RunComponents
from campaigns import Catalogue
from campaigns.checked.snapshot import changes, snapshot
from campaigns.identity.code import code_of
from campaigns.versions import Versions


def components(reader: sa.Connection, run_id: int) -> RunComponents:
    """As stored with the run; if nothing was stored, as described now. 404 if there is no such run."""
    campaign = service.campaign(reader, run_id)
    kept = snapshots.of_run(reader, run_id)
    digest, versions = reader.execute(sa.select(Run.snapshot, Run.flown).where(Run.id == run_id)).one()
    then, now = Versions.of(versions).code, code_of(campaign, codes.installed(reader))
    others = [] if then == now else codes.changed(reader, then)
    changes_of_code = [*others, *_own(Versions.of(versions), published(reader))]
    described = partial(RunComponents, code=then, code_installed=now, code_changes=changes_of_code)
    if kept is None:
        return described(digest=None, catalogue=snapshot(campaign, required(reader)), changes=[])
    return described(digest=digest, catalogue=kept, changes=changed(kept, published(reader)))


def _own(then: Versions, installed: Catalogue | None) -> list[str]:
    """The operator's own components of a run whose files have changed or are gone."""
    now = {} if installed is None else installed.own
    return [f"components/{name}" for name, digest in then.components.items() if now.get(name) != digest]


def changed(kept: Catalogue, installed: Catalogue | None) -> list[str]:
    if installed is None:
        return []
    return [f"{clause[0].upper()}{clause[1:]}." for clause in changes(kept, installed)]
