"""The table of what keeps a run waiting although workers are there. Import it from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


class RunRefusal(Base):
    """An installation that cannot continue a run, because other code began it; its workers leave the run alone."""

    __tablename__ = "run_refusals"
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    installation: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """Digest of the files and packages that its workers have loaded."""
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """What differs, as clauses."""
    created: orm.Mapped[float]
