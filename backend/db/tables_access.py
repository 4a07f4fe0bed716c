"""The tables of access control, and of what users write and do: sign-offs, drafts, audit trail, Idempotency-Keys.

Only hashes of secrets are stored. Import them from `backend.db.tables`, which has all other tables.
"""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.base import Base
from campaigns.documents import JsonObject


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


class Signoff(Base):
    """A reviewer's sign-off of a run's results; never edited, only withdrawn. A valid one protects its run."""

    __tablename__ = "signoffs"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    run_id: orm.Mapped[int] = orm.mapped_column(sa.ForeignKey("runs.id"), index=True)
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    """As typed; empty if signed under the account's name."""
    role: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    comment: orm.Mapped[str] = orm.mapped_column(sa.Text)
    digest: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """Digest of the signed results; see `backend.db.digest`."""
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """The user, or the name of the token."""
    account: orm.Mapped[str] = orm.mapped_column(sa.String(64), server_default="")
    """The user, also of a token."""
    texts: orm.Mapped[dict[str, str] | None]
    """The texts of the run's requirements when it was signed, by id; None: not stored by earlier versions."""
    known: orm.Mapped[dict[str, str] | None]
    """How other runs spoke against its verdict when it was signed all the same, by run; None: this was not stated."""
    created: orm.Mapped[float]
    withdrawn: orm.Mapped[float | None]
    withdrawn_by: orm.Mapped[str | None] = orm.mapped_column(sa.String(64))
    withdrawn_reason: orm.Mapped[str | None] = orm.mapped_column(sa.Text)


class Draft(Base):
    """The original text of a campaign in preparation; it may be incomplete or invalid. Its owner may edit it."""

    __tablename__ = "drafts"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    version: orm.Mapped[int] = orm.mapped_column(default=1)
    """Incremented by every save; a save that names an older version is refused."""
    name: orm.Mapped[str] = orm.mapped_column(sa.String(120))
    tags: orm.Mapped[list[Any]]
    text: orm.Mapped[str] = orm.mapped_column(sa.Text)
    """YAML or JSON."""
    owner: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """The user who created it, also by a token."""
    created: orm.Mapped[float]
    saved: orm.Mapped[float] = orm.mapped_column(index=True)
    saved_by: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    run_id: orm.Mapped[int | None] = orm.mapped_column(sa.ForeignKey("runs.id", ondelete="SET NULL"))
    """The last run started from it."""
    # Numbers are never reused: the address of a deleted draft must not lead to another one.
    __table_args__ = ({"sqlite_autoincrement": True},)


class Audit(Base):
    """Who did what, and when; append-only, and each row holds the hash of the one before; see `backend.db.audit`."""

    __tablename__ = "audit"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=True)
    """Consecutive, from 1."""
    at: orm.Mapped[float] = orm.mapped_column(index=True)
    user: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    via: orm.Mapped[str] = orm.mapped_column(sa.String(12))
    action: orm.Mapped[str] = orm.mapped_column(sa.String(40), index=True)
    subject: orm.Mapped[str] = orm.mapped_column(sa.String(80), index=True)
    detail: orm.Mapped[JsonObject]
    previous: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64))
    """SHA-256 of all other columns as canonical JSON; see `backend.db.chain`."""


class AuditHead(Base):
    """The newest row of the audit trail, in one row: writers lock it, and it shows that rows at the end are missing."""

    __tablename__ = "audit_head"
    id: orm.Mapped[int] = orm.mapped_column(primary_key=True, autoincrement=False)
    """Always 1."""
    row: orm.Mapped[int]
    """0 in an empty trail."""
    hash: orm.Mapped[str] = orm.mapped_column(sa.String(64))


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
