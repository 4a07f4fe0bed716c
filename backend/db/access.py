"""API tokens, login links and sessions as rows: only the SHA-256 of a secret is stored; the secret is shown once.

A secret has 256 random bits, so a plain hash is sufficient (OWASP Session Management Cheat Sheet, entropy), and looking
up a hash leaks nothing about the secret.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass, field
from typing import Any, Literal

import sqlalchemy as sa

from backend.db import engine
from backend.db.tables import LoginLink, Session, Token

TOKEN_PREFIX = "clr_"
"""Prefix of every API token, so that a token that leaked into a file can be found by searching."""

LINK_LIFETIME = 15 * 60.0
"""How long an unused login link is valid [s]."""

SESSION_LIFETIME = 14 * 24 * 3600.0
"""How long a browser stays signed in [s]."""

USE_NOTED = 60.0
"""The time of a token's last use is written at most this often [s]."""

_NAME = re.compile(r"[\w.+-]{1,64}")


class AccessError(ValueError):
    """A token cannot be created or revoked; the message says why and what to do."""


@dataclass(frozen=True)
class Visitor:
    """The user behind a request, and how they authenticated."""

    user: str
    via: Literal["link", "token"]
    key: str = field(default="", compare=False, repr=False)
    """Identifies the browser session or the token: its stored hash."""


def hashed(secret: str) -> str:
    """The stored form of a token, a login code or a session cookie: SHA-256, 64 hexadecimal digits."""
    return hashlib.sha256(secret.encode()).hexdigest()


def create_token(connection: sa.Connection, name: str) -> str:
    """Create an API token under a new name and return it; it cannot be read again later."""
    if not _NAME.fullmatch(name):
        raise AccessError(f"the name {name!r} is invalid: use 1 to 64 letters, digits and . _ + -, no spaces")
    if connection.scalar(sa.select(Token.id).where(Token.name == name)) is not None:
        raise AccessError(f"a token named {name!r} exists or existed; choose another name")
    secret = TOKEN_PREFIX + secrets.token_urlsafe(32)
    values = {"name": name, "hash": hashed(secret), "created": engine.now(connection)}
    connection.execute(sa.insert(Token).values(**values))
    return secret


def tokens(connection: sa.Connection) -> list[sa.Row[tuple[str, float, float | None, float | None]]]:
    """Name, created, last used and revoked [s since 1970] of every token, oldest first."""
    columns = (Token.name, Token.created, Token.last_used, Token.revoked)
    return list(connection.execute(sa.select(*columns).order_by(Token.id)))


def revoke_token(connection: sa.Connection, name: str) -> None:
    """Revoke a token; its row stays, so that the audit trail can still be attributed to its name."""
    known = sa.update(Token).where(Token.name == name)
    if connection.execute(known.values(revoked=sa.func.coalesce(Token.revoked, engine.now(connection)))).rowcount == 0:
        raise AccessError(f"there is no token named {name!r}; `clearance token list` lists all tokens")


def create_login_code(connection: sa.Connection, lifetime: float = LINK_LIFETIME) -> str:
    """Create the code of a single-use login link, valid for `lifetime` [s]; voids all earlier unused codes."""
    code = secrets.token_urlsafe(32)
    created = engine.now(connection)
    old = sa.or_(LoginLink.used.is_(None), LoginLink.expires < created - 7 * 24 * 3600.0)
    connection.execute(sa.delete(LoginLink).where(old))
    values = {"hash": hashed(code), "created": created, "expires": created + lifetime}
    connection.execute(sa.insert(LoginLink).values(**values))
    return code


def valid_codes(connection: sa.Connection) -> frozenset[str]:
    """The hashes of all login codes that are valid now."""
    good = (LoginLink.used.is_(None), LoginLink.expires > engine.now(connection))
    return frozenset(connection.scalars(sa.select(LoginLink.hash).where(*good)))


def open_session(connection: sa.Connection, code: str, user: str) -> str | None:
    """Use a login code; returns the secret of a new session, or None if the code is wrong, used or expired."""
    at = engine.now(connection)
    good = (LoginLink.hash == hashed(code), LoginLink.used.is_(None), LoginLink.expires > at)
    if connection.execute(sa.update(LoginLink).where(*good).values(used=at)).rowcount != 1:
        return None
    secret = secrets.token_urlsafe(32)
    connection.execute(sa.delete(Session).where(Session.expires < at))
    values = {"hash": hashed(secret), "user": user, "created": at, "expires": at + SESSION_LIFETIME}
    connection.execute(sa.insert(Session).values(**values))
    return secret


def close_session(connection: sa.Connection, secret: str) -> None:
    """Sign a browser out."""
    connection.execute(sa.delete(Session).where(Session.hash == hashed(secret)))


def by_session(connection: sa.Connection, secret: str) -> Visitor | None:
    """The visitor to whom a session cookie belongs."""
    row = _found(connection, sa.select(Session.hash, Session.user, Session.expires), Session.hash, secret)
    return Visitor(row.user, "link", row.hash) if row is not None and row.expires > engine.now(connection) else None


def by_token(connection: sa.Connection, secret: str) -> tuple[Visitor, bool] | None:
    """The visitor to whom an API token belongs, and whether its use should be recorded now."""
    columns = (Token.hash, Token.name, Token.revoked, Token.last_used)
    row = _found(connection, sa.select(*columns), Token.hash, secret)
    if row is None or row.revoked is not None:
        return None
    return Visitor(row.name, "token", row.hash), engine.now(connection) - (row.last_used or 0.0) > USE_NOTED


def note_use(connection: sa.Connection, name: str) -> None:
    """Record the time of a token's last use."""
    connection.execute(sa.update(Token).where(Token.name == name).values(last_used=engine.now(connection)))


def _found(connection: sa.Connection, query: Any, column: Any, secret: str) -> Any:
    wanted = hashed(secret)
    row = connection.execute(query.where(column == wanted)).one_or_none()
    return row if row is not None and hmac.compare_digest(row.hash, wanted) else None
