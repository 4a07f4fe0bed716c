"""The tables of catalogues, code versions and measurements of simulators. Import them from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class CatalogueDocument(Base):
    """The catalogue of the newest worker; a single row."""

    __tablename__ = "catalogue"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    document: orm.Mapped[JsonObject]
    published: orm.Mapped[float]
    code: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Code digest of that worker."""
    departed: orm.Mapped[float | None]
    """When a worker last stopped in an orderly way."""


class CatalogueSnapshot(Base):
    """The component and method descriptions of a campaign when its run was submitted, by digest; shared by runs."""

    __tablename__ = "catalogue_snapshots"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    document: orm.Mapped[JsonObject]
    """A catalogue with only the entries that were used; see `campaigns.checked.snapshot`."""
    created: orm.Mapped[float]


class CodeVersion(Base):
    """The module digests of an installation's code, by their overall digest; shared by runs."""

    __tablename__ = "code_versions"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    modules: orm.Mapped[dict[str, str]]
    """{module: digest}; see `campaigns.versions`."""
    created: orm.Mapped[float]


class SimulatorMeasurement(Base):
    """What `clearance check-simulator` measured of a simulator; the newest of each declaration and files."""

    __tablename__ = "simulator_measurements"
    simulator: orm.Mapped[str] = orm.mapped_column(sa.String(160), primary_key=True)
    """Its name with the digest of its declaration, as a run needs it; see `SimulatorEntry.version`."""
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(128), primary_key=True)
    """Of its files, when it was opened."""
    measured: orm.Mapped[float]
    """When [s since 1970]."""
    host: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    result: orm.Mapped[JsonObject]
    """See `campaigns.results.nominal.Measured`."""
