"""The tables of what belongs to launched runs: labels, baselines, refusals, requirements, sources, sweeps.

Import them from `backend.db.tables`.
"""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class RunLabel(Base):
    """One label of a run, see `campaigns.labels`; keys that begin with @ are those of `backend.db.groups`."""

    __tablename__ = "run_labels"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    key: orm.Mapped[str] = orm.mapped_column(sa.String(40), primary_key=True)
    value: orm.Mapped[str] = orm.mapped_column(sa.String(200))
    __table_args__ = (sa.Index("ix_run_labels_value", "key", "value", "run_id"),)


class RunBaseline(Base):
    """The baseline that a run was launched with; its findings are in the run's campaign."""

    __tablename__ = "run_baselines"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    asked: orm.Mapped[str] = orm.mapped_column(sa.String(300))
    """As given: R-0001, or label:branch=main."""
    baseline: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id"))
    """None if no run has the label: nothing is compared."""


class RunRefusal(Base):
    """An installation that cannot continue a run, because other code began it; its workers leave the run alone."""

    __tablename__ = "run_refusals"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    installation: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """Digest of the files and packages that its workers have loaded."""
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """What differs, as clauses."""
    created: orm.Mapped[float]


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


class Sweep(Base):
    """One campaign with several values of a fixed parameter, launched together."""

    __tablename__ = "sweeps"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    campaign_name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    path: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    """The parameter, such as avoider.d_0."""
    title: orm.Mapped[str] = orm.mapped_column(sa.String(400))
    """Its description, as in the catalogue at submission."""
    unit: orm.Mapped[str] = orm.mapped_column(sa.String(30))
    nominal: orm.Mapped[float | None]
    """Its value in the campaign; None if that gave none."""
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    token: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """As of a run."""
    created: orm.Mapped[float]


class SweepRun(Base):
    """A run of a sweep."""

    __tablename__ = "sweep_runs"
    sweep_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("sweeps.id", ondelete="CASCADE"), primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    value: orm.Mapped[float]
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), index=True, unique=True)
