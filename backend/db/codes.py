"""The code digests of installations, by module; stored once for all runs of the same code."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import insert, now
from backend.db.tables import CatalogueDocument, CodeVersion
from campaigns.versions import Code, Versions, differences, differing


def store(writer: sa.Connection, code: Code) -> None:
    """Store the digests of the modules unless they are already stored."""
    row = {"digest": code.digest, "modules": code.modules, "created": now(writer)}
    writer.execute(insert(writer, CodeVersion).values(**row).on_conflict_do_nothing())


def published(reader: sa.Connection) -> str | None:
    """The code digest of the newest worker; None if no worker has published one."""
    return reader.scalar(sa.select(CatalogueDocument.code).order_by(CatalogueDocument.published.desc()).limit(1))


def modules(reader: sa.Connection, digest: str | None) -> dict[str, str]:
    """The digests of the modules of a code; empty if they are not stored."""
    return reader.scalar(sa.select(CodeVersion.modules).where(CodeVersion.digest == digest)) or {}


def changed(reader: sa.Connection, then: str | None, now: str | None) -> list[str]:
    """The modules that differ between two codes; empty unless both are stored."""
    before, after = modules(reader, then), modules(reader, now)
    return differing(before, after) if before and after else []


def others(reader: sa.Connection, then: Versions, here: Versions, code: Code) -> list[str]:
    """The differences between the installation that ran a run and this one, as clauses."""
    before = modules(reader, then.code)
    return differences(then, here, differing(before, code.modules) if before else [])
