"""The tables of the sources of components that are not shipped. Import them from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class RunSources(Base):
    """The source files of a run's components that are not shipped; absent if all are."""

    __tablename__ = "run_sources"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    document: orm.Mapped[JsonObject]
    """`campaigns.capsules.sources.Sources`."""


class SourceText(Base):
    """The text of a source file, stored once for all runs of it."""

    __tablename__ = "source_texts"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """SHA-256."""
    content: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
