"""Snapshots of the component descriptions that runs used, stored once for all runs with the same ones."""

from __future__ import annotations

import functools
from typing import Any

import sqlalchemy as sa

from backend.db.engine import insert, now, once
from backend.db.tables import CatalogueSnapshot, Run
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.snapshot import digest_of, snapshot


def store(writer: sa.Connection, campaign: Campaign, catalogue: Catalogue) -> str:
    """Store the catalogue entries of a campaign's components unless they are already stored; returns their digest."""
    document = snapshot(campaign, catalogue).model_dump(mode="json")
    digest = digest_of(document)
    row = {"digest": digest, "document": document, "created": now(writer)}
    writer.execute(insert(writer, CatalogueSnapshot).values(**row).on_conflict_do_nothing())
    return digest


def of_run(reader: sa.Connection, run_id: int) -> Catalogue | None:
    """The descriptions of a run's components; None if none were stored or there is no such run.

    Raises `ValidationError` if another version stored them in a form that this one cannot read.
    """
    stored = _stored(sa.cast(CatalogueSnapshot.document, sa.Text), run_id)
    text: str | None = once(reader, ("snapshot", run_id), lambda: reader.scalar(stored))
    return None if text is None else _read(text)


def version(reader: sa.Connection, run_id: int) -> str:
    """The version that the stored descriptions state, also if this version cannot read them; empty if they state
    none."""
    document: object = reader.scalar(_stored(CatalogueSnapshot.document, run_id))
    stated = document.get("version") if isinstance(document, dict) else None
    return stated if isinstance(stated, str) else ""


def digest(reader: sa.Connection, run_id: int) -> str | None:
    """The digest of the stored snapshot, computed again so that a later change is detected; None without a snapshot."""
    document: dict[str, object] | None = reader.scalar(_stored(CatalogueSnapshot.document, run_id))
    return None if document is None else digest_of(document)


def _stored(what: Any, run_id: int) -> sa.Select[Any]:
    return sa.select(what).join(Run, Run.snapshot == CatalogueSnapshot.digest).where(Run.id == run_id)


@functools.lru_cache(maxsize=32)
def _read(text: str) -> Catalogue:
    """Cached: it is needed for every response with parameters in their units."""
    return Catalogue.model_validate_json(text)
