"""The identity of stored runs, and what differs between two of them, or from what is installed. Read `of_run`."""

from __future__ import annotations

import json
from collections.abc import Collection
from functools import lru_cache
from typing import Any

import sqlalchemy as sa

from backend.catalog.installation import installation
from backend.db import codes
from backend.db.engine import chunks
from backend.db.tables import CampaignRow, Run
from campaigns import Campaign, Catalogue, check
from campaigns.identity.identity import UNSTORED, Change, Identity, changes, identity_of, installed, unsound
from campaigns.runs import run_name
from campaigns.versions import Versions, differing

MOST_SHOWN = 5
"""Problems of a campaign in one sentence."""
COLUMNS = (
    sa.cast(Run.flown, sa.Text).label("flown"),
    Run.summary["provenance"].as_string().label("provenance"),
    CampaignRow.document["simulator"]["name"].as_string().label("simulator"),
)
"""What `of_row` needs, of runs joined with their campaigns."""


def of_row(row: Any) -> Identity | None:
    """The identity of a run from its `COLUMNS`; None if it has not begun, or if nothing was stored when it began."""
    return with_digest(row)[0]


def with_digest(row: Any) -> tuple[Identity | None, str | None]:
    """The identity of a run, and its digest."""
    return _of_texts(row.flown, row.provenance, row.simulator)


@lru_cache(maxsize=1024)
def _of_texts(flown: str | None, provenance: str | None, simulator: str | None) -> tuple[Identity | None, str | None]:
    found = _of_text(flown, simulator) or _of_text(provenance, simulator)
    return found, None if found is None else found.digest


@lru_cache(maxsize=1024)
def _of_text(text: str | None, simulator: str | None) -> Identity | None:
    """The identity in a stored document; most runs of a list have the same."""
    stored = json.loads(text) if text else None
    return identity_of(Versions.of(stored), simulator or "") if stored else None


def of_runs(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, Identity]:
    """The identities of the runs that have one, by the run's number."""
    found = {}
    for some in chunks(run_ids):
        of = sa.select(Run.id, *COLUMNS).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        for row in reader.execute(of.where(Run.id.in_(some))):
            if (identity := of_row(row)) is not None:
                found[int(row.id)] = identity
    return found


def of_run(reader: sa.Connection, run_id: int) -> Identity | None:
    return of_runs(reader, [run_id]).get(run_id)


def of_installed(reader: sa.Connection, campaign: Campaign, then: Identity) -> Identity | None:
    """What a run of the campaign would have now; None if no live worker reports it. then: see `installed`."""
    catalogue = installation(reader).catalogue
    return None if catalogue is None else installed(campaign, catalogue, then)


def apart(
    reader: sa.Connection, then: Identity, now: Identity, same_modules: bool = True, same_files: bool = True
) -> list[Change]:
    """What is known to differ between two identities, with the modules of the engine that differ, if stored.

    same_modules: whether both campaigns use the same parts of the engine, as those of equal digests do; same_files:
    the same components, as those of equal definitions do. Else what only one of them uses is no change of the code.
    """
    before, after = codes.modules(reader, then.engine), codes.modules(reader, now.engine)
    known = differing(before, after) if before and after else []
    if not same_modules and known:
        known = [name for name in known if name in before and name in after]
        if not known:
            then = then.model_copy(update={"engine": now.engine} | ({} if same_files else {"loop": now.loop}))
    found = changes(then, now, known)
    return found if same_files else [one for one in found if (one.before and one.after) or "/" not in one.name]


def names(found: Collection[Change]) -> list[str]:
    """The files and packages of changes, own files first."""
    return [name for change in sorted(found, key=lambda one: bool(one.modules)) for name in change.names]


def unusable(run_id: int, campaign: Campaign, catalogue: Catalogue) -> str | None:
    """Why the newest worker cannot run the campaign; None if it can."""
    if not (problems := check(campaign, catalogue)):
        return None
    found = "; ".join(map(str, problems[:MOST_SHOWN]))
    return f"the campaign of {run_name(run_id)} cannot be run with what the newest worker has installed: {found}"


def not_continuable(reader: sa.Connection, run_id: int, campaign: Campaign, catalogue: Catalogue) -> str | None:
    """Why the newest worker can continue nothing of it; None if it can."""
    if detail := unusable(run_id, campaign, catalogue):
        return detail
    then = of_run(reader, run_id) or UNSTORED
    others = unsound(then, installed(campaign, catalogue, then))
    if not others:
        return None
    return (
        f"the code that evaluates differs between {run_name(run_id)} and the newest worker, or was not "
        f"stored ({'; '.join(others)}): none of its evaluations can be used; begin it again, or start a worker of "
        "its version"
    )
