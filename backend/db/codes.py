"""The code digests of runs and installations, by module; stored once for all runs of the same code."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.engine import insert, now
from backend.db.tables import CatalogueDocument, CodeVersion
from campaigns.versions import Code


def store(writer: sa.Connection, code: Code) -> None:
    row = {"digest": code.digest, "modules": code.modules, "created": now(writer)}
    writer.execute(insert(writer, CodeVersion).values(**row).on_conflict_do_nothing())


def published(reader: sa.Connection) -> str | None:
    """The digest of all code of the newest worker; None if no worker has published one."""
    return reader.scalar(sa.select(CatalogueDocument.code))


def modules(reader: sa.Connection, digest: str | None) -> dict[str, str]:
    """The digests of the modules of a code; empty if they are not stored."""
    return reader.scalar(sa.select(CodeVersion.modules).where(CodeVersion.digest == digest)) or {}


def changed(reader: sa.Connection, then: str | None) -> list[str]:
    """The modules of a run's code that are others or gone at the newest worker; empty unless both are stored."""
    before, after = modules(reader, then), modules(reader, published(reader))
    return sorted(name for name, digest in before.items() if after.get(name) != digest) if after else []
