"""The tables of requirements: imported or written here, and stated by the campaigns of runs.

Import them from `backend.db.tables`.
"""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


class RequirementFile(Base):
    """An imported file, byte by byte: it is written back unchanged."""

    __tablename__ = "requirement_files"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(200), unique=True)
    """A later import under the same name replaces it."""
    kind: orm.Mapped[str] = orm.mapped_column(sa.String(8))
    """csv, reqif"""
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """SHA-256 of the content."""
    content: orm.Mapped[bytes] = orm.mapped_column(sa.LargeBinary)
    imported: orm.Mapped[float]
    imported_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))


class Requirement(Base):
    """A requirement that was imported or written here. One that only campaigns state has no row."""

    __tablename__ = "requirements"
    id: orm.Mapped[str] = orm.mapped_column(sa.String(120), primary_key=True)
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    attributes: orm.Mapped[dict[str, str]]
    """The other attributes of its file, as text by name."""
    file_id: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("requirement_files.id"), index=True)
    """None: written here."""
    created: orm.Mapped[float]
    changed: orm.Mapped[float]
    """When its text was last changed, or it was created."""
    changed_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))


class RunRequirement(Base):
    """A requirement that the campaign of a run states, written when the run is submitted."""

    __tablename__ = "run_requirements"
    requirement: orm.Mapped[str] = orm.mapped_column(sa.String(120), primary_key=True)
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), primary_key=True, index=True)
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """Its text in the campaign; empty if the campaign gives the id alone."""
    question: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """See `campaigns.asked.requirements.question`."""
