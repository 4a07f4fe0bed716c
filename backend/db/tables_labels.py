"""The tables of labels and baselines of runs, given at launch. Import them from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


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
