"""The tables of access control: users, invitations, API tokens, login links, sessions, settings.

Only hashes of secrets are stored. Import them from `backend.db.tables`, which has all other tables.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base


class User(Base):
    """A user. The row stays when access is withdrawn, so that records can still be attributed to the name."""

    __tablename__ = "users"
    name: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    """Never the name of a token: runs and the audit trail name both."""
    role: orm.Mapped[str] = orm.mapped_column(sa.String(12))
    password: orm.Mapped[str | None] = orm.mapped_column(sa.String(200))
    """Argon2id; None: this user has not accepted the invitation, or signs in with the login link."""
    created: orm.Mapped[float]
    created_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """A user, or the identity of a provider's user; see `backend.db.identities`."""
    joined: orm.Mapped[float | None]
    """When the first invitation was accepted."""
    disabled: orm.Mapped[float | None]


class Invitation(Base):
    """A single-use link with which a user sets a password; a new one voids the earlier ones of that user."""

    __tablename__ = "invitations"
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64), primary_key=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64), index=True)
    created: orm.Mapped[float]
    created_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    expires: orm.Mapped[float]
    used: orm.Mapped[float | None]


class Token(Base):
    """An API token; only its hash is stored."""

    __tablename__ = "tokens"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(64), unique=True)
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64), unique=True)
    created: orm.Mapped[float]
    last_used: orm.Mapped[float | None]
    revoked: orm.Mapped[float | None]
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64), default="local", server_default="local")
    scope: orm.Mapped[str] = orm.mapped_column(sa.String(8), default="admin", server_default="admin")
    """read, run, admin; tokens that are older than this column could do everything, and still can."""
    expires: orm.Mapped[float | None]


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
    via: orm.Mapped[str] = orm.mapped_column(sa.String(12), default="link", server_default="link")
    """link, password, provider"""
    agent: orm.Mapped[str] = orm.mapped_column(sa.String(200), default="", server_default="")
    """The browser's description of itself."""
    address: orm.Mapped[str] = orm.mapped_column(sa.String(64), default="", server_default="")
    """The network address from which it was opened."""


class ServiceSetting(Base):
    """A setting that administrators change while the service runs; absent: the default."""

    __tablename__ = "service_settings"
    key: orm.Mapped[str] = orm.mapped_column(sa.String(40), primary_key=True)
    value: orm.Mapped[list[Any]]
    """A list with one value, because a JSON column stores a bare false or null differently on every database."""
