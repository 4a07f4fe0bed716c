"""The tables of access control: API tokens, login links, sessions. Only hashes of secrets are stored.

Import them from `backend.db.tables`, which has all other tables.
"""

from __future__ import annotations

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


class Token(Base):
    """An API token; only its hash is stored."""

    __tablename__ = "tokens"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(64), unique=True)
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64), unique=True)
    created: orm.Mapped[float]
    last_used: orm.Mapped[float | None]
    revoked: orm.Mapped[float | None]


class LoginLink(Base):
    """A single-use login link; a new one voids all unused ones."""

    __tablename__ = "login_links"
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    created: orm.Mapped[float]
    expires: orm.Mapped[float]
    used: orm.Mapped[float | None]


class Session(Base):
    """A browser session; only the hash of its cookie is stored."""

    __tablename__ = "sessions"
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    created: orm.Mapped[float]
    expires: orm.Mapped[float]
