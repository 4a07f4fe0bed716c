"""API tokens, login links and sessions as rows: only the SHA-256 of a secret is kept, the secret is shown once.

The secrets are 256 random bits, so that a plain hash is enough (OWASP Session Management Cheat Sheet, entropy), and
looking a hash up leaks nothing of the secret. Start reading at `hashed`.
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
"""Opens every API token, so that one that leaked into a file can be found by searching."""

LINK_LIFETIME = 15 * 60.0
"""How long an unused login link is good [s]."""

SESSION_LIFETIME = 14 * 24 * 3600.0
"""How long a browser stays signed in [s]."""

USE_NOTED = 60.0
"""The time of a token's last use is written at most this often [s]."""

_NAME = re.compile(r"[\w.+-]{1,64}")


class AccessError(ValueError):
    """A token cannot be created or revoked; the message says why and what to do."""


@dataclass(frozen=True)
class Visitor:
    """Who is asking, and how they came in."""

    user: str
    via: Literal["link", "token"]
    key: str = field(default="", compare=False, repr=False)
    """Tells one browser's session, or one token, from another: the hash that the tables keep."""


def hashed(secret: str) -> str:
    """What the tables keep of a token, a login code or a session cookie: SHA-256, 64 hexadecimal digits."""
    return hashlib.sha256(secret.encode()).hexdigest()


def create_token(connection: sa.Connection, name: str) -> str:
    """A new API token under a name not used before; this is the only time that it can be seen."""
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
    """From now on the token is refused; its row stays, so that the name still says who it was."""
    known = sa.update(Token).where(Token.name == name)
    if connection.execute(known.values(revoked=sa.func.coalesce(Token.revoked, engine.now(connection)))).rowcount == 0:
        raise AccessError(f"there is no token named {name!r}; `clearance token list` lists all tokens")


def create_login_code(connection: sa.Connection, lifetime: float = LINK_LIFETIME) -> str:
    """The code of a fresh login link, single-use and valid for `lifetime` [s]; voids every earlier unused one."""
    code = secrets.token_urlsafe(32)
    created = engine.now(connection)
    old = sa.or_(LoginLink.used.is_(None), LoginLink.expires < created - 7 * 24 * 3600.0)
    connection.execute(sa.delete(LoginLink).where(old))
    values = {"hash": hashed(code), "created": created, "expires": created + lifetime}
    connection.execute(sa.insert(LoginLink).values(**values))
    return code


def good_codes(connection: sa.Connection) -> frozenset[str]:
    """The hashes of the login codes that would open a session now."""
    good = (LoginLink.used.is_(None), LoginLink.expires > engine.now(connection))
    return frozenset(connection.scalars(sa.select(LoginLink.hash).where(*good)))


def open_session(connection: sa.Connection, code: str, user: str) -> str | None:
    """Use a login link up: the secret of a new session, or None when the code is wrong, used or expired."""
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
    """The visitor a session's cookie belongs to."""
    row = _found(connection, sa.select(Session.hash, Session.user, Session.expires), Session.hash, secret)
    return Visitor(row.user, "link", row.hash) if row is not None and row.expires > engine.now(connection) else None


def by_token(connection: sa.Connection, secret: str) -> tuple[Visitor, bool] | None:
    """The visitor an API token belongs to, and whether its use should be noted now."""
    columns = (Token.hash, Token.name, Token.revoked, Token.last_used)
    row = _found(connection, sa.select(*columns), Token.hash, secret)
    if row is None or row.revoked is not None:
        return None
    return Visitor(row.name, "token", row.hash), engine.now(connection) - (row.last_used or 0.0) > USE_NOTED


def note_use(connection: sa.Connection, name: str) -> None:
    """Write down that a token was used."""
    connection.execute(sa.update(Token).where(Token.name == name).values(last_used=engine.now(connection)))


def _found(connection: sa.Connection, query: Any, column: Any, secret: str) -> Any:
    wanted = hashed(secret)
    row = connection.execute(query.where(column == wanted)).one_or_none()
    return row if row is not None and hmac.compare_digest(row.hash, wanted) else None
