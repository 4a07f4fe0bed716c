"""Which schema a database has and which is the newest, without Alembic, which takes 0.2 s to load. See `migrate`."""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa

VERSIONS = Path(__file__).parent / "migrations" / "versions"
"""Each file begins with the number of its revision."""
FORMER_TABLES = frozenset({"alembic_version", "idempotency_keys"})
"""Alembic's, and those that only earlier revisions have."""


def known() -> frozenset[str]:
    return frozenset(file.name.partition("_")[0] for file in VERSIONS.glob("[0-9]*.py"))


def newest() -> str:
    return max(known())


def stored(connection: sa.Connection) -> str | None:
    """The revision of a database; None for one that was never migrated."""
    if not sa.inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.scalar(sa.text("select version_num from alembic_version"))
    return found
