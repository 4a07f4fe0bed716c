"""Users of an OpenID Connect provider: identified by issuer and subject, never by a name or an e-mail address.

Such a user is the one whose `created_by` is the identity's digest. It is written once, when the user is created, so no
identity can take over a user who was invited, and a provider's user has neither password nor invitation.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.access import close_sessions, token_named
from backend.db.engine import now
from backend.db.roles import ROLES, Role, Scope, has_scope, widest
from backend.db.tables import Token, User

PREFIX = "provider:"
"""Begins `created_by` of a provider's users; no name of a user or token contains a colon."""

_LEFT = re.compile(r"[^a-z0-9]+")
_FOREIGN = re.compile(r"[^a-z0-9._+@-]+")


@dataclass(frozen=True)
class SignedIn:
    """A provider's user after a sign-in; before: the earlier role, None for a new user."""

    name: str
    role: Role
    before: Role | None


def identity_of(issuer: str, subject: str) -> str:
    """The stored form of an identity: a digest, 64 characters."""
    digest = hashlib.sha256(f"{issuer}\0{subject}".encode("utf-8", "surrogatepass")).hexdigest()
    return PREFIX + digest[: 64 - len(PREFIX)]


def is_provided(created_by: str) -> bool:
    return created_by.startswith(PREFIX)


@dataclass(frozen=True)
class Provided:
    name: str
    role: Role
    disabled: float | None


def user_of(reader: sa.Connection, identity: str) -> Provided | None:
    of = sa.select(User.name, User.role, User.disabled).where(User.created_by == identity)
    row = reader.execute(of).one_or_none()
    return None if row is None else Provided(**row._mapping)


def sign_in(writer: sa.Connection, identity: str, wish: str, role: Role) -> SignedIn | None:
    """Create or update the user of an identity; None if an administrator has disabled that user.

    A lower role revokes the tokens whose scope it does not cover. wish: what the provider calls the user; if another
    user or a token has that name, the new user gets one of their own.
    """
    found = user_of(writer, identity)
    if found is None:
        at, name = now(writer), _free(writer, wish, identity)
        writer.execute(sa.insert(User).values(name=name, role=role, created=at, created_by=identity, joined=at))
        return SignedIn(name, role, None)
    if found.disabled is not None:
        return None
    if found.role != role:
        writer.execute(sa.update(User).where(User.name == found.name).values(role=role))
        _revoke(writer, found.name, widest(role))
    return SignedIn(found.name, role, found.role)


def withdraw(writer: sa.Connection, identity: str) -> tuple[str, dict[str, object]] | None:
    """End all access of an identity whose groups give no role: its sessions and its tokens. The user, and how many."""
    found = user_of(writer, identity)
    if found is None:
        return None
    sessions, tokens = close_sessions(writer, found.name), _revoke(writer, found.name, None)
    writer.execute(sa.update(User).where(User.name == found.name).values(role=ROLES[0]))
    return found.name, {"role": found.role, "sessions": sessions, "tokens": tokens}


def _revoke(writer: sa.Connection, owner: str, covered: Scope | None) -> int:
    """Revoke the tokens that are wider than the scope; None: all of them."""
    mine = sa.select(Token.id, Token.scope).where(Token.owner == owner, Token.revoked.is_(None))
    wide = [row.id for row in writer.execute(mine) if covered is None or not has_scope(covered, row.scope)]
    writer.execute(sa.update(Token).where(Token.id.in_(wide)).values(revoked=now(writer)))
    return len(wide)


def _free(reader: sa.Connection, wish: str, identity: str) -> str:
    """A name that neither a user nor a token has; the same for the same identity."""
    short = identity.removeprefix(PREFIX)[:10]
    plain = _LEFT.sub("", wish.strip().lower()[:1]) + _FOREIGN.sub("-", wish.strip().lower()[:200])[1:]
    name = plain[:64] if re.fullmatch(r"[a-z0-9][a-z0-9._+@-]*", plain) else f"user-{short}"
    for candidate in (name, f"{name[:53]}-{short}"):
        taken = reader.scalar(sa.select(User.name).where(User.name == candidate))
        if taken is None and not token_named(reader, candidate):
            return candidate
    return f"user-{identity.removeprefix(PREFIX)[:50]}"
