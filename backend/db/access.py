"""Who may come in: API tokens, login links and sessions, of which only SHA-256 hashes are kept.

The secrets are 256 bits from the system's generator, so a fast hash is enough (NIST SP 800-63B, section 5.1.2.2, asks
for slow ones only below 112 bits) and looking a hash up leaks nothing of the secret. Start reading at `create_token`.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass
from typing import Any, Literal

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import LoginLink, Session, Token

LINK_LIFETIME = 24 * 3600.0
"""How long a login link waits to be opened [s]."""

SESSION_LIFETIME = 14 * 24 * 3600.0
"""How long a browser stays signed in [s]."""

TOKEN_PREFIX = "clr_"
"""Lets a person, and a scanner for leaked secrets, recognise a token."""

TOKEN_NOTED = 60.0
"""The time of a token's last use is written at most this often [s]."""


@dataclass(frozen=True)
class Visitor:
    """Who is asking, and how they came in."""

    user: str
    via: Literal["link", "token"]


def hashed(secret: str) -> str:
    """The hash under which a secret is kept, 64 hexadecimal digits."""
    return hashlib.sha256(secret.encode()).hexdigest()


def create_token(connection: sa.Connection, name: str) -> str:
    """A new API token; returned once, kept as a hash. Raises `ValueError` when the name is taken or unfit."""
    if not name or len(name) > 64 or not name.isprintable():
        raise ValueError(f"a token's name has 1 to 64 printable characters, given {name!r}")
    if connection.scalar(sa.select(Token.id).where(Token.name == name)) is not None:
        raise ValueError(f"there is a token named {name!r} already; revoke it or choose another name")
    secret = TOKEN_PREFIX + secrets.token_urlsafe(32)
    connection.execute(sa.insert(Token).values(name=name, hash=hashed(secret), created=now(connection)))
    return secret


def revoke_token(connection: sa.Connection, name: str) -> bool:
    """End a token; False when there is none of that name still good. Its name stays taken, as a record."""
    done = connection.execute(
        sa.update(Token).where(Token.name == name, Token.revoked.is_(None)).values(revoked=now(connection))
    )
    return done.rowcount > 0


def create_link(connection: sa.Connection, lifetime: float = LINK_LIFETIME) -> str:
    """The code of a new login link, good once and for `lifetime` seconds."""
    code, time = secrets.token_urlsafe(32), now(connection)
    connection.execute(sa.delete(LoginLink).where(LoginLink.expires < time))
    connection.execute(sa.insert(LoginLink).values(hash=hashed(code), created=time, expires=time + lifetime))
    return code


def open_session(connection: sa.Connection, code: str, user: str) -> str | None:
    """Use a login link up: the secret of a new session, or None when the code is wrong, used or expired."""
    time = now(connection)
    used = connection.execute(
        sa.update(LoginLink)
        .where(LoginLink.hash == hashed(code), LoginLink.used.is_(None), LoginLink.expires > time)
        .values(used=time)
    )
    if used.rowcount != 1:
        return None
    secret = secrets.token_urlsafe(32)
    connection.execute(sa.delete(Session).where(Session.expires < time))
    connection.execute(
        sa.insert(Session).values(hash=hashed(secret), user=user, created=time, expires=time + SESSION_LIFETIME)
    )
    return secret


def close_session(connection: sa.Connection, secret: str) -> None:
    """Sign a browser out."""
    connection.execute(sa.delete(Session).where(Session.hash == hashed(secret)))


def by_session(connection: sa.Connection, secret: str) -> Visitor | None:
    """The visitor a session's cookie belongs to."""
    row = _found(connection, sa.select(Session.hash, Session.user, Session.expires), Session.hash, secret)
    return Visitor(row.user, "link") if row is not None and row.expires > now(connection) else None


def by_token(connection: sa.Connection, secret: str) -> tuple[Visitor, bool] | None:
    """The visitor an API token belongs to, and whether its use should be noted now."""
    row = _found(connection, sa.select(Token.hash, Token.name, Token.revoked, Token.last_used), Token.hash, secret)
    if row is None or row.revoked is not None:
        return None
    return Visitor(row.name, "token"), now(connection) - (row.last_used or 0.0) > TOKEN_NOTED


def note_use(connection: sa.Connection, name: str) -> None:
    """Write down that a token was used."""
    connection.execute(sa.update(Token).where(Token.name == name).values(last_used=now(connection)))


def _found(connection: sa.Connection, query: Any, column: Any, secret: str) -> Any:
    wanted = hashed(secret)
    row = connection.execute(query.where(column == wanted)).one_or_none()
    return row if row is not None and hmac.compare_digest(row.hash, wanted) else None
