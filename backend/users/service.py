"""Inviting and changing users, and the settings, each with its row in the audit trail."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import audit, identities, users
from backend.db.access import Visitor
from backend.db.engine import now
from backend.db.roles import LOCAL
from backend.http.errors import RefusedError, existing
from backend.http.matches import require_match, tag
from backend.users.schemas import AccessSettings, Invitation, User, UserChange, UserInvite
from campaigns import Problem

PROVIDER = "the sign-in provider"
"""Shown as the creator of the provider's users."""


def listed(reader: sa.Connection) -> list[User]:
    return [_user(row) for row in users.users(reader)]


def invite(writer: sa.Connection, invitation: UserInvite, public_url: str, visitor: Visitor) -> Invitation:
    """Create a user and the link; raises `AccessError` if the name cannot be used."""
    name = invitation.name.strip().lower()
    code = users.invite(writer, name, invitation.role, visitor.account)
    audit.note(writer, visitor, "user.invited", name, {"role": invitation.role})
    return _link(writer, name, code, public_url)


def renew(writer: sa.Connection, name: str, public_url: str, visitor: Visitor) -> Invitation:
    """A new link for a user who lost the first one or forgot the password. 409 for a disabled user."""
    user = one(writer, name)
    if user.disabled is not None:
        raise RefusedError("access-conflict", f"the access of {name} is withdrawn: grant it again first")
    if user.provided:
        detail = f"{name} signs in through the provider, which also renews forgotten passwords: there is no link"
        raise RefusedError("access-conflict", detail)
    code = users.renew(writer, name, visitor.account)
    audit.note(writer, visitor, "user.link_made", name, {})
    return _link(writer, name, code, public_url)


def one(reader: sa.Connection, name: str) -> User:
    """A user, or 404."""
    return existing(next((user for user in listed(reader) if user.name == name), None), "user", name)


def change(engine: sa.Engine, name: str, wanted: UserChange, visitor: Visitor, match: str | None = None) -> User:
    """Change role or access; 409 for yourself and for the user of the login link, 422 without a change, 412 if `match`
    (If-Match) is not the user's tag."""
    if wanted.role is None and wanted.disabled is None:
        message = "give at least one of role and disabled"
        raise RefusedError("invalid", message, [Problem("role", "", message)])
    with engine.begin() as writer:
        users.hold(writer, name)
        user = one(writer, name)
        if name == visitor.account:
            detail = "you cannot change your own role or access: ask another administrator"
            raise RefusedError("access-conflict", detail)
        require_match(match, user.etag, f"the user {name}")
        role = None if wanted.role == user.role else wanted.role
        disabled = None if wanted.disabled == (user.disabled is not None) else wanted.disabled
        if user.provided and role is not None:
            detail = f"the role of {name} follows the groups of the sign-in provider: change them there"
            raise RefusedError("access-conflict", detail)
        if role is not None:
            users.set_role(writer, name, role)
        if disabled is not None:
            users.set_disabled(writer, name, disabled)
        if role is not None:
            audit.note(writer, visitor, "user.role_changed", name, {"before": user.role, "after": role})
        if disabled is not None:
            audit.note(writer, visitor, "user.disabled" if disabled else "user.enabled", name, {})
        return one(writer, name)


def settings(reader: sa.Connection) -> AccessSettings:
    return AccessSettings(own_sign_offs=users.own_sign_offs(reader))


def etag(found: AccessSettings) -> str:
    return tag(found.own_sign_offs)


def change_settings(
    engine: sa.Engine, own_sign_offs: bool, visitor: Visitor, match: str | None = None
) -> AccessSettings:
    """Store the settings; 412 if `match` (If-Match) is not their tag."""
    with engine.begin() as writer:
        users.hold(writer, LOCAL)  # settings that were never changed have no row of their own
        before = users.own_sign_offs(writer)
        require_match(match, tag(before), "a setting")
        # A choice is stored also where it is the default, which changes once another user is invited.
        if own_sign_offs != users.stored_own_sign_offs(writer):
            users.set_own_sign_offs(writer, own_sign_offs)
            detail = {"before": before, "after": own_sign_offs}
            audit.note(writer, visitor, "setting.changed", users.OWN_SIGN_OFFS, detail)
        return settings(writer)


def _link(writer: sa.Connection, name: str, code: str, public_url: str) -> Invitation:
    expires = now(writer) + users.INVITATION_LIFETIME
    address = public_url.rstrip("/") or None
    return Invitation(user=name, path=f"/invite?code={code}", address=address, expires=expires)


def _user(row: users.UserRow) -> User:
    provided = identities.is_provided(row.created_by)
    joined = row.has_password or row.name == LOCAL or provided
    state = "disabled" if row.disabled is not None else "active" if joined else "invited"
    shown = {**row.__dict__, "created_by": PROVIDER if provided else row.created_by, "provided": provided}
    return User.model_validate(
        {**shown, "state": state, "fixed": row.name == LOCAL, "etag": tag(row.role, row.disabled)}
    )
