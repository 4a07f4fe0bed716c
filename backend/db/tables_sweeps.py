"""The tables of sweeps. Import them from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


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
    created: orm.Mapped[float]


class SweepRun(Base):
    """A run of a sweep."""

    __tablename__ = "sweep_runs"
    sweep_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("sweeps.id", ondelete="CASCADE"), primary_key=True)
    position: orm.Mapped[int] = orm.mapped_column(primary_key=True)
    value: orm.Mapped[float]
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), index=True, unique=True)
