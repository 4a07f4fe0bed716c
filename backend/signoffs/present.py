"""What runs of now would be of: the newest definition of each campaign, and what the workers have installed."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import sqlalchemy as sa

from backend.catalog.service import published
from backend.db import codes
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run, SweepRun
from campaigns import CampaignError, Catalogue
from campaigns.asked.load import load_document
from campaigns.asked.requirements import definition
from campaigns.identity.code import code_of
from campaigns.runs import run_name
from campaigns.versions import CodeParts, Versions, short

Value = TypeVar("Value", int, str)
CHUNK = 500
"""Values that are read in one statement."""


def chunks(values: Iterable[Value]) -> Iterator[list[Value]]:
    """The values in order, as many at a time as one statement reads."""
    ordered = sorted(values)
    return (ordered[first : first + CHUNK] for first in range(0, len(ordered), CHUNK))


@dataclass(frozen=True)
class Present:
    """code, catalogue: of the newest worker; newest: run and definition by the name of a campaign."""

    code: CodeParts | None
    catalogue: Catalogue | None
    newest: Mapping[str, tuple[int, str]]


def counted() -> tuple[sa.ColumnElement[bool], ...]:
    return Run.removed.is_(None), Run.purged.is_(None), ~in_sweep()


def in_sweep() -> sa.ColumnElement[bool]:
    return sa.exists().where(SweepRun.run_id == Run.id)


def present(reader: sa.Connection, names: Collection[str]) -> Present:
    newest: dict[str, tuple[int, str]] = {}
    for some in chunks(names):
        of = sa.select(sa.func.max(Run.id)).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        last = of.where(CampaignRow.name.in_(some), *counted()).group_by(CampaignRow.name)
        found = sa.select(Run.id, CampaignRow.name, CampaignRow.document)
        found = found.join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(Run.id.in_(last))
        newest |= {row.name: (int(row.id), definition(row.document)) for row in reader.execute(found)}
    return Present(codes.installed(reader), published(reader), newest)


def changes(now: Present, run_id: int, name: str, document: Mapping[str, Any], flown: Any) -> Iterator[str]:
    """What differs between a run and now, as clauses; what is not stored is named, not taken for equal."""
    newer, defined = now.newest.get(name, (run_id, ""))
    if defined and defined != definition(document):
        yield f"its campaign has changed, see {run_name(newer)}"
    versions = Versions.of(flown)
    if now.code is None or now.catalogue is None:
        yield "no worker has published the code to compare it with"
        return
    try:
        code = code_of(load_document(document, f"the campaign of {run_name(run_id)}"), now.code)
    except CampaignError:
        yield "this version cannot read its campaign, so a change cannot be excluded"
        return
    if versions.code is None:
        yield "its code is not stored, so a change of the model cannot be excluded"
    elif code is None:
        yield "a part of it is no longer installed"
    elif versions.code != code:
        yield f"the code has changed (sha256 {short(versions.code)}, now {short(code)})"
    for file, digest in versions.components.items():
        if now.catalogue.own.get(file) != digest:
            yield f"components/{file} {'has changed' if file in now.catalogue.own else 'is no longer installed'}"
    yield from _simulator(now.catalogue, versions, document)


def _simulator(catalogue: Catalogue, versions: Versions, document: Mapping[str, Any]) -> Iterator[str]:
    name = (document.get("simulator") or {}).get("name")
    if name is None:
        return
    installed = catalogue.digests.get(name)
    if versions.simulator is None:
        yield "the digest of its simulator is not stored, so a change cannot be excluded"
    elif installed is None:
        yield f"no worker publishes the digest of the simulator {name}, so a change cannot be excluded"
    elif installed != versions.simulator:
        yield f"the simulator {name} has changed (sha256 {short(versions.simulator)}, now {short(installed)})"
