"""API tokens and login links as rows: only the SHA-256 of a secret is kept, the secret itself is shown once.

The secrets are 256 random bits, so that a plain hash is enough (OWASP Session Management Cheat Sheet, entropy).
Start reading at `hashed`.
"""

from __future__ import annotations

import hashlib
import re
import secrets

import sqlalchemy as sa

from backend.db import engine
from backend.db.tables import LoginLink, Token

TOKEN_PREFIX = "clr_"
"""Opens every API token, so that one that leaked into a file can be found by searching."""

LINK_LIFETIME = 12 * 3600.0
"""How long an unused login link is good [s]."""

_NAME = re.compile(r"[\w.+-]{1,64}")


class AccessError(ValueError):
    """A token cannot be created or revoked; the message says why and what to do."""


def hashed(secret: str) -> str:
    """What the tables keep of a token, a login code or a session cookie: SHA-256, 64 hexadecimal digits."""
    return hashlib.sha256(secret.encode()).hexdigest()


def create_token(connection: sa.Connection, name: str) -> str:
    """A new API token under a name not used before; this is the only time that it can be seen."""
    if not _NAME.fullmatch(name):
        raise AccessError(f"the name {name!r} does not fit: 1 to 64 letters, digits and . _ + -, no spaces")
    if connection.scalar(sa.select(Token.id).where(Token.name == name)) is not None:
        raise AccessError(f"there is, or was, a token named {name!r}; choose another name")
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
        raise AccessError(f"there is no token named {name!r}; `clearance token list` shows those there are")


def create_login_code(connection: sa.Connection, lifetime: float = LINK_LIFETIME) -> str:
    """The code of a fresh login link, good once and for `lifetime` [s]; codes long expired are cleared away."""
    code = secrets.token_urlsafe(32)
    created = engine.now(connection)
    connection.execute(sa.delete(LoginLink).where(LoginLink.expires < created - 7 * 24 * 3600.0))
    values = {"hash": hashed(code), "created": created, "expires": created + lifetime}
    connection.execute(sa.insert(LoginLink).values(**values))
    return code
