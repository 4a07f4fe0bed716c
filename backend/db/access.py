"""API tokens, login links and sessions as rows: only the SHA-256 of a secret is stored; the secret is shown once.

A secret has 256 random bits, so a plain hash is sufficient (OWASP Session Management Cheat Sheet, entropy), and looking
up a hash leaks nothing about the secret. Roles are read with every request: a change applies at once.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import sqlalchemy as sa

from backend.db import engine
from backend.db.roles import LOCAL, ROLES, SCOPES, Role, Scope, has_scope, widest
from backend.db.tables import LoginLink, Session, Token, User
from campaigns.refusals import Refusal, RefusalCode

TOKEN_PREFIX = "clr_"
"""Prefix of every API token, so that a token that leaked into a file can be found by searching."""

LINK_LIFETIME = 15 * 60.0
"""How long an unused login link is valid [s]."""

SESSION_LIFETIME = 14 * 24 * 3600.0
"""How long a browser stays signed in [s]."""

PROVIDER_SESSION_LIFETIME = 12 * 3600.0
"""How long a browser stays signed in through a provider [s]: whoever left a group is refused at the next sign-in."""

USE_NOTED = 60.0
"""The time of a token's last use is written at most this often [s]."""

SESSION_ID = 16
"""Leading digits of a session's hash by which its owner names it: they reveal nothing of the cookie."""

MOST_TOKENS = 20
"""Tokens of a user that are neither revoked nor expired."""

_NAME = re.compile(r"[\w.+-]{1,64}")
_OF_USER = (User.role, User.disabled, User.password.is_not(None).label("has_password"))


class AccessError(Refusal, ValueError):
    """A token cannot be created or revoked; the message gives the reason and what to do."""


@dataclass(frozen=True)
class Visitor:
    """The user behind a request, and how they authenticated."""

    user: str
    """What records name: the user, or the token's name."""
    via: Literal["link", "password", "provider", "token"]
    key: str = field(default="", compare=False, repr=False)
    """Identifies the browser session or the token: its stored hash."""
    account: str = LOCAL
    """The user, or the token's owner."""
    role: Role = field(default="viewer", compare=False)
    """The account's role; a token is limited by its scope, too."""
    scope: Scope | None = field(default=None, compare=False)
    """The token's scope; None for a browser session."""
    has_password: bool = field(default=False, compare=False)
    """Whether the account can sign in with a password."""

    @property
    def token(self) -> str | None:
        """The name of the token; None for a browser session."""
        return self.user if self.via == "token" else None

    @property
    def sees_all(self) -> bool:
        """Whether what belongs to other users is theirs to change."""
        return self.role == "admin" and self.scope in (None, "admin")


@dataclass(frozen=True)
class TokenInfo:
    """An API token without its secret; times in seconds since 1970."""

    name: str
    owner: str
    scope: str
    created: float
    expires: float | None
    last_used: float | None
    revoked: float | None


def hashed(secret: str) -> str:
    """The stored form of a token, a login code or a session cookie: SHA-256, 64 hexadecimal digits."""
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def create_token(
    connection: sa.Connection,
    name: str,
    owner: str = LOCAL,
    scope: Scope = "admin",
    lifetime: float | None = None,
) -> str:
    """Create an API token under a new name and return it; it cannot be read again later. lifetime: [s], None: no end.

    Raises `AccessError` if the name is taken, also by a user, if the scope is wider than the owner's role, and if the
    owner has as many as one may have.
    """
    if not _NAME.fullmatch(name):
        raise AccessError(f"the name {name!r} is invalid: use 1 to 64 letters, digits and . _ + -, no spaces")
    lower = name.lower()
    if token_named(connection, lower):
        raise AccessError(f"a token named {name!r} exists or existed; choose another name", RefusalCode.NAME_TAKEN)
    if connection.scalar(sa.select(User.name).where(User.name == lower)) is not None:
        raise AccessError(
            f"{name!r} is the name of a user; choose another name, such as {name[:60]}-ci", RefusalCode.NAME_TAKEN
        )
    of = sa.select(User.role).where(User.name == owner, User.disabled.is_(None))
    role = connection.scalar(
        of.with_for_update()
    )  # another of the same owner waits, so that none is missed in the count
    if role not in ROLES:
        raise AccessError(f"there is no active user {owner!r} to own the token")
    if not has_scope(widest(role), scope):
        raise AccessError(f"the scope {scope} is wider than the role {role} of {owner!r}: give {widest(role)} or less")
    secret, created = TOKEN_PREFIX + secrets.token_urlsafe(32), engine.now(connection)
    valid = (Token.owner == owner, Token.revoked.is_(None), sa.or_(Token.expires.is_(None), Token.expires > created))
    if (connection.scalar(sa.select(sa.func.count()).where(*valid)) or 0) >= MOST_TOKENS:
        raise AccessError(
            f"{owner!r} has {MOST_TOKENS} valid tokens, which is the limit: revoke one that is not needed"
        )
    values = {"name": name, "hash": hashed(secret), "created": created, "owner": owner, "scope": scope}
    values["expires"] = None if lifetime is None else created + lifetime
    connection.execute(sa.insert(Token).values(**values))
    return secret


def token_named(connection: sa.Connection, lower: str) -> bool:
    """Whether a token has or had this name, in small letters; SQLite knows only those of ASCII."""
    return any(name.lower() == lower for name in connection.scalars(sa.select(Token.name)))


def tokens(connection: sa.Connection, owner: str | None = None) -> list[TokenInfo]:
    """The tokens of a user, or all, oldest first."""
    columns = (Token.name, Token.owner, Token.scope, Token.created, Token.expires, Token.last_used, Token.revoked)
    of = sa.select(*columns).order_by(Token.id)
    rows = connection.execute(of if owner is None else of.where(Token.owner == owner))
    return [TokenInfo(**row._mapping) for row in rows]


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
    good = (LoginLink.used.is_(None), LoginLink.expires > engine.now(connection))
    return frozenset(connection.scalars(sa.select(LoginLink.hash).where(*good)))


def use_login_code(connection: sa.Connection, code: str) -> bool:
    """Use a login code; false if it is wrong, used or expired."""
    at = engine.now(connection)
    good = (LoginLink.hash == hashed(code), LoginLink.used.is_(None), LoginLink.expires > at)
    return connection.execute(sa.update(LoginLink).where(*good).values(used=at)).rowcount == 1


def open_session(
    connection: sa.Connection,
    user: str,
    via: str,
    agent: str = "",
    address: str = "",
    lifetime: float = SESSION_LIFETIME,
) -> str:
    """Open a browser session; returns its secret. lifetime: [s]."""
    secret, at = secrets.token_urlsafe(32), engine.now(connection)
    connection.execute(sa.delete(Session).where(Session.expires < at))
    values = {"hash": hashed(secret), "user": user, "created": at, "expires": at + lifetime}
    values |= {"via": via, "agent": agent[:200], "address": address[:64]}
    connection.execute(sa.insert(Session).values(**values))
    return secret


def sessions(reader: sa.Connection, user: str | None = None) -> Sequence[sa.Row[Any]]:
    """The open sessions of a user, or all, newest first; each with its id instead of its hash."""
    short = sa.func.substr(Session.hash, 1, SESSION_ID).label("id")
    columns = (Session.user, Session.via, Session.created, Session.expires, Session.agent, Session.address)
    of = sa.select(short, *columns).where(Session.expires > engine.now(reader)).order_by(Session.created.desc())
    return reader.execute(of if user is None else of.where(Session.user == user)).all()


def close_session(connection: sa.Connection, secret: str) -> str | None:
    """Sign a browser out; returns the user of the session, None if there was none."""
    return _closed(connection, Session.hash == hashed(secret))


def revoke_session(connection: sa.Connection, session_id: str, user: str | None) -> str | None:
    """Close the session of this id, of this user or of any; returns its user, None if there is none."""
    mine = () if user is None else (Session.user == user,)
    return _closed(connection, sa.func.substr(Session.hash, 1, SESSION_ID) == session_id, *mine)


def close_sessions(connection: sa.Connection, user: str, but: str = "") -> int:
    """Close all sessions of a user but the one of this hash; returns how many."""
    return connection.execute(sa.delete(Session).where(Session.user == user, Session.hash != but)).rowcount


def by_session(connection: sa.Connection, secret: str) -> Visitor | None:
    columns = (Session.hash, Session.user, Session.expires, Session.via, *_OF_USER)
    of = sa.select(*columns).join(User, User.name == Session.user)
    row = _found(connection, of, Session.hash, secret)
    if row is None or row.expires <= engine.now(connection) or row.disabled is not None or row.role not in ROLES:
        return None
    return Visitor(row.user, row.via, row.hash, row.user, row.role, None, row.has_password)


def by_token(connection: sa.Connection, secret: str) -> tuple[Visitor, bool] | None:
    """The visitor to whom an API token belongs, and whether its use should be recorded now."""
    columns = (Token.hash, Token.name, Token.revoked, Token.last_used, Token.owner, Token.scope, Token.expires)
    of = sa.select(*columns, *_OF_USER).join(User, User.name == Token.owner)
    row, at = _found(connection, of, Token.hash, secret), engine.now(connection)
    if row is None or row.revoked is not None or row.disabled is not None:
        return None
    if (row.expires is not None and row.expires <= at) or row.role not in ROLES or row.scope not in SCOPES:
        return None
    visitor = Visitor(row.name, "token", row.hash, row.owner, row.role, row.scope, row.has_password)
    return visitor, at - (row.last_used or 0.0) > USE_NOTED


def note_use(connection: sa.Connection, name: str) -> None:
    connection.execute(sa.update(Token).where(Token.name == name).values(last_used=engine.now(connection)))


def _closed(connection: sa.Connection, *which: sa.ColumnElement[bool]) -> str | None:
    user = connection.scalar(sa.select(Session.user).where(*which))
    connection.execute(sa.delete(Session).where(*which))
    return user


def _found(connection: sa.Connection, query: Any, column: Any, secret: str) -> Any:
    wanted = hashed(secret)
    row = connection.execute(query.where(column == wanted)).one_or_none()
    return row if row is not None and hmac.compare_digest(row.hash, wanted) else None
