"""The tables of what users write and do: sign-offs, drafts, the audit trail. Import them from `backend.db.tables`."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class Signoff(Base):
    """A reviewer's sign-off of a run's results; never edited, only withdrawn. A valid one protects its run."""

    __tablename__ = "signoffs"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), index=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    role: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    comment: orm.Mapped[str] = orm.mapped_column(sa.Text)
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """Digest of the signed results; see `backend.db.digest`."""
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    created: orm.Mapped[float]
    withdrawn: orm.Mapped[float | None]
    withdrawn_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    withdrawn_reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)


class Draft(Base):
    """The original text of a campaign in preparation; it may be incomplete or invalid. Its owner may edit it."""

    __tablename__ = "drafts"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    version: orm.Mapped[int] = orm.mapped_column(default=1)
    """Incremented by every save; a save that names an older version is refused."""
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    tags: orm.Mapped[list[Any]]
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """YAML or JSON."""
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """The user who created it."""
    created: orm.Mapped[float]
    saved: orm.Mapped[float] = orm.mapped_column(index=True)
    saved_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    run_id: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="SET NULL"))
    """The last run started from it."""
    # Numbers are never reused: the address of a deleted draft must not lead to another one.
    __table_args__ = ({"sqlite_autoincrement": True},)


class Audit(Base):
    """Who did what, and when; append-only, and each row holds the hash of the one before; see `backend.db.audit`."""

    __tablename__ = "audit"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    """Consecutive, from 1."""
    at: orm.Mapped[float] = orm.mapped_column(index=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    via: orm.Mapped[str] = orm.mapped_column(sa.String(12))
    action: orm.Mapped[str] = orm.mapped_column(sa.String(40), index=True)
    subject: orm.Mapped[str] = orm.mapped_column(sa.String(80), index=True)
    detail: orm.Mapped[JsonObject]
    previous: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """SHA-256 of all other columns as canonical JSON; see `backend.db.chain`."""


class AuditHead(Base):
    """The newest row of the audit trail, in one row: writers lock it, and it shows that rows at the end are missing."""

    __tablename__ = "audit_head"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=False)
    """Always 1."""
    row: orm.Mapped[int]
    """0 in an empty trail."""
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64))
