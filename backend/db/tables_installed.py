"""The tables of what is or was installed: catalogues and code. They are imported from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


class CatalogueDocument(Base):
    """The catalogue of the newest worker; one row."""

    __tablename__ = "catalogue"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    document: orm.Mapped[JsonObject]
    published: orm.Mapped[float]
    code: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    """Digest of the code of that worker."""


class CatalogueSnapshot(Base):
    """What the components and methods of a campaign meant when its run was submitted, by its digest; shared by runs."""

    __tablename__ = "catalogue_snapshots"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    document: orm.Mapped[JsonObject]
    """A catalogue with the used entries alone; see `campaigns.checked.snapshot`."""
    created: orm.Mapped[float]


class CodeVersion(Base):
    """The code of an installation, module by module, by its digest; shared by the runs that it flew."""

    __tablename__ = "code_versions"
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    modules: orm.Mapped[JsonObject]
    """{module: digest}; see `campaigns.flown`."""
    created: orm.Mapped[float]
