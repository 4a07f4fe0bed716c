"""The table of answered requests, by their Idempotency-Key. Import it from `backend.db.tables`."""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


class RequestKey(Base):
    """A write that was done under an Idempotency-Key: repeated, it is not done again."""

    __tablename__ = "request_keys"
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """The user, or the name of the token."""
    operation: orm.Mapped[str] = orm.mapped_column(sa.String(20), primary_key=True)
    """The operation's id in the OpenAPI document."""
    key: orm.Mapped[str] = orm.mapped_column(sa.String(128), primary_key=True)
    body: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """Digest of the request, to distinguish a repeated one from another one."""
    made: orm.Mapped[str] = orm.mapped_column(sa.String(300))
    """What it made, as sentences name it: R-0001, the token 'ci'."""
    answer: orm.Mapped[bytes | None] = orm.mapped_column(sa.LargeBinary)
    """Its answer, JSON compressed with zlib; None if it was a secret, is read again, or was forgotten."""
    created: orm.Mapped[float]
    __table_args__ = (sa.Index("ix_request_keys_created", "user", "created"),)
