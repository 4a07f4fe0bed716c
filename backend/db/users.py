"""Users: invited by a single-use link, with a role, disabled but never deleted."""

from __future__ import annotations

import re
import secrets
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.access import AccessError, close_sessions, hashed, token_named
from backend.db.engine import now
from backend.db.roles import LOCAL, ROLES, Role
from backend.db.tables import Invitation, ServiceSetting, Session, User

INVITATION_LIFETIME = 3 * 24 * 3600.0
"""How long an unused invitation is valid [s]."""

OWN_SIGN_OFFS = "own_sign_offs"
"""The setting that permits users to sign off runs that they launched."""

_NAME = re.compile(r"[a-z0-9][a-z0-9._+@-]{0,63}")
_EVERY = (User.name, User.role, User.created, User.created_by, User.joined, User.disabled)


@dataclass(frozen=True)
class UserRow:
    """A user without the password; times in seconds since 1970."""

    name: str
    role: Role
    created: float
    created_by: str
    joined: float | None
    disabled: float | None
    has_password: bool
    invited_until: float | None
    """When the open invitation expires; None if there is none."""
    sessions: int


def users(reader: sa.Connection) -> list[UserRow]:
    at = now(reader)
    open_ = (Invitation.used.is_(None), Invitation.expires > at)
    invited = dict(reader.execute(sa.select(Invitation.user, Invitation.expires).where(*open_)).all())
    counted = sa.select(Session.user, sa.func.count()).where(Session.expires > at).group_by(Session.user)
    signed_in = dict(reader.execute(counted).all())
    of = sa.select(*_EVERY, User.password.is_not(None).label("has_password")).order_by(User.name)
    return [
        UserRow(**row._mapping, invited_until=invited.get(row.name), sessions=signed_in.get(row.name, 0))
        for row in reader.execute(of)
    ]


def hold(writer: sa.Connection, name: str) -> None:
    """Let no other transaction change this user until the end of this one. SQLite has one writer anyway."""
    writer.execute(sa.select(User.name).where(User.name == name).with_for_update())


def role_of(reader: sa.Connection, name: str) -> Role | None:
    """The role of a user, also of a disabled one; None if there is no such user."""
    role = reader.scalar(sa.select(User.role).where(User.name == name))
    return role if role in ROLES else None


def creator_of(reader: sa.Connection, name: str) -> str | None:
    return reader.scalar(sa.select(User.created_by).where(User.name == name))


def password_of(reader: sa.Connection, name: str) -> str | None:
    """The stored password of a user who may sign in with one."""
    return reader.scalar(sa.select(User.password).where(User.name == name, User.disabled.is_(None)))


def with_passwords(reader: sa.Connection) -> bool:
    of = sa.select(User.name).where(User.password.is_not(None), User.disabled.is_(None)).limit(1)
    return reader.scalar(of) is not None


def invite(writer: sa.Connection, name: str, role: Role, by: str) -> str:
    """Create a user; returns the code of the invitation. Raises `AccessError` if the name cannot be used."""
    if not _NAME.fullmatch(name):
        raise AccessError(
            f"the name {name[:100]!r} is invalid: use 1 to 64 lower-case letters, digits and . _ + @ -, "
            "beginning with a letter or a digit"
        )
    if role_of(writer, name) is not None:
        raise AccessError(f"there is a user {name!r} already: make a new link for that user, or choose another name")
    if token_named(writer, name):
        raise AccessError(f"a token named {name!r} exists or existed: choose another name")
    writer.execute(sa.insert(User).values(name=name, role=role, created=now(writer), created_by=by))
    return renew(writer, name, by)


def renew(writer: sa.Connection, name: str, by: str) -> str:
    """The code of a new link with which an existing user sets a password; voids earlier unused ones."""
    code, at = secrets.token_urlsafe(32), now(writer)
    void_invitations(writer, name)
    values = {"hash": hashed(code), "user": name, "created": at, "created_by": by, "expires": at + INVITATION_LIFETIME}
    writer.execute(sa.insert(Invitation).values(**values))
    return code


def void_invitations(writer: sa.Connection, name: str) -> None:
    writer.execute(sa.delete(Invitation).where(Invitation.user == name, Invitation.used.is_(None)))


def invited(reader: sa.Connection, code: str) -> str | None:
    """The user whom a link invites; None if it is wrong, used or expired, or the user is disabled."""
    of = sa.select(Invitation.user).join(User, User.name == Invitation.user)
    return reader.scalar(of.where(*_open(reader, code), User.disabled.is_(None)))


def has_joined(reader: sa.Connection, name: str) -> bool:
    return reader.scalar(sa.select(User.joined).where(User.name == name)) is not None


def accept(writer: sa.Connection, code: str, password: str) -> str | None:
    """Use an invitation: store the (hashed) password and end the user's sessions. The user; None as for `invited`."""
    name, at = invited(writer, code), now(writer)
    if name is None:
        return None
    if writer.execute(sa.update(Invitation).where(*_open(writer, code)).values(used=at)).rowcount != 1:
        return None
    joined = sa.func.coalesce(User.joined, at)
    writer.execute(sa.update(User).where(User.name == name).values(password=password, joined=joined))
    close_sessions(writer, name)
    return name


def set_password(writer: sa.Connection, name: str, password: str, but: str) -> None:
    """Store a new (hashed) password; ends the user's open links, and all sessions but the one of the hash `but`."""
    writer.execute(sa.update(User).where(User.name == name).values(password=password))
    void_invitations(writer, name)
    close_sessions(writer, name, but)


def set_role(writer: sa.Connection, name: str, role: Role) -> None:
    """Change a role; `local` stays an administrator."""
    _changeable(name)
    writer.execute(sa.update(User).where(User.name == name).values(role=role))


def set_disabled(writer: sa.Connection, name: str, disabled: bool) -> None:
    """Withdraw a user's access, which also ends sessions and links, or grant it again."""
    _changeable(name)
    writer.execute(sa.update(User).where(User.name == name).values(disabled=now(writer) if disabled else None))
    if disabled:
        close_sessions(writer, name)
        void_invitations(writer, name)


def own_sign_offs(reader: sa.Connection) -> bool:
    """Whether users may sign off runs that they launched. By default only while `local` is the only user."""
    stored = stored_own_sign_offs(reader)
    return only_local(reader) if stored is None else stored


def only_local(reader: sa.Connection) -> bool:
    """Whether the service has no accounts but the one of the login link, which belongs to no particular user."""
    return reader.scalar(sa.select(User.name).where(User.name != LOCAL).limit(1)) is None


def stored_own_sign_offs(reader: sa.Connection) -> bool | None:
    """The setting of sign-offs of one's own runs as an administrator chose it; None if none did."""
    stored = reader.scalar(sa.select(ServiceSetting.value).where(ServiceSetting.key == OWN_SIGN_OFFS))
    return bool(stored[0]) if stored else None


def set_own_sign_offs(writer: sa.Connection, permitted: bool) -> None:
    writer.execute(sa.delete(ServiceSetting).where(ServiceSetting.key == OWN_SIGN_OFFS))
    writer.execute(sa.insert(ServiceSetting).values(key=OWN_SIGN_OFFS, value=[permitted]))


def _changeable(name: str) -> None:
    if name == LOCAL:
        raise AccessError(
            f"{LOCAL!r} is the user of the login link and stays an administrator: a link is made on the machine of the "
            "service, by whoever may read its database"
        )


def _open(reader: sa.Connection, code: str) -> tuple[sa.ColumnElement[bool], ...]:
    return Invitation.hash == hashed(code), Invitation.used.is_(None), Invitation.expires > now(reader)
