"""GET and POST /users, GET and PATCH of one, new links, and the settings of access; changes with their audit rows."""

from __future__ import annotations

from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Path, Request, Response, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.db import audit, identities, users
from backend.db.access import LOCAL, Visitor
from backend.db.engine import now
from backend.http.deps import Engine, Reader
from backend.http.errors import RefusedError, not_found, problems
from backend.http.matches import TAGGED, IfMatch, require_match, tag
from backend.users.schemas import AccessSettings, AccessSettingsChange, Invitation, User, UserChange, UserInvite
from campaigns import Problem

router = APIRouter(tags=["users"])

MADE = problems("access-conflict", *ONCE)
RENEW = "make a new link with another key; the earlier one becomes invalid"
PROVIDER = "the sign-in provider"
"""Shown as the creator of the provider's users."""

UserName = Annotated[str, Path(max_length=64, description="The user by name.")]


@router.get("/users")
def list_users(reader: Reader) -> list[User]:
    """All users, by name."""
    return [_user(row) for row in users.users(reader)]


@router.post("/users", status_code=status.HTTP_201_CREATED, responses=MADE)
def invite_user(invitation: UserInvite, request: Request, once: OnceOnly, visitor: CurrentVisitor) -> Invitation:
    """Create a user and a single-use link, valid for three days, with which the user sets a password."""
    address, name = request.app.state.settings.public_url, invitation.name.strip().lower()

    def invite(writer: sa.Connection) -> Invitation:
        code = users.invite(writer, name, invitation.role, visitor.account)
        audit.note(writer, visitor, "user.invited", name, {"role": invitation.role})
        return _link(writer, name, code, address)

    return once.do_secretly(invite, f"the invitation of {name}", RENEW)


@router.get("/users/{user}", responses=TAGGED | problems("not-found"))
def get_user(user: UserName, response: Response, reader: Reader) -> User:
    """One user."""
    found = _one(reader, user)
    response.headers["ETag"] = found.etag
    return found


@router.patch("/users/{user}", responses=TAGGED | problems("not-found", "access-conflict", "invalid", "changed"))
def change_user(
    user: UserName,
    change: UserChange,
    response: Response,
    engine: Engine,
    visitor: CurrentVisitor,
    match: IfMatch = None,
) -> User:
    """Change a user's role, or withdraw or grant access; both apply at once, to tokens and open browsers, too."""
    if change.role is None and change.disabled is None:
        message = "give at least one of role and disabled"
        raise RefusedError("invalid", message, [Problem("role", "", message)])
    with engine.begin() as writer:
        users.hold(writer, user)
        before = _one(writer, user)
        if user == visitor.account:
            detail = "you cannot change your own role or access: ask another administrator"
            raise RefusedError("access-conflict", detail)
        require_match(match, before.etag, f"the user {user}")
        role = None if change.role == before.role else change.role
        disabled = None if change.disabled == (before.disabled is not None) else change.disabled
        if before.provided and role is not None:
            detail = f"the role of {user} follows the groups of the sign-in provider: change them there"
            raise RefusedError("access-conflict", detail)
        if role is not None:
            users.set_role(writer, user, role)
        if disabled is not None:
            users.set_disabled(writer, user, disabled)
        # Rows of the trail come last, see `audit`.
        if role is not None:
            audit.note(writer, visitor, "user.role_changed", user, {"before": before.role, "after": role})
        if disabled is not None:
            audit.note(writer, visitor, "user.disabled" if disabled else "user.enabled", user, {})
        changed = _one(writer, user)
    response.headers["ETag"] = changed.etag
    return changed


@router.post(
    "/users/{user}/invitation",
    status_code=status.HTTP_201_CREATED,
    responses=MADE | problems("not-found"),
)
def renew_invitation(user: UserName, request: Request, once: OnceOnly, visitor: CurrentVisitor) -> Invitation:
    """A new link for a user to set a password; earlier unused ones become invalid."""
    address = request.app.state.settings.public_url
    return once.do_secretly(lambda writer: _renewed(writer, user, address, visitor), f"a link for {user}", RENEW)


@router.get("/settings", responses=TAGGED)
def get_settings(response: Response, reader: Reader) -> AccessSettings:
    """The settings that administrators change while the service runs."""
    return _tagged(response, users.own_sign_offs(reader))


@router.patch("/settings", responses=TAGGED | problems("changed"))
def change_settings(
    settings: AccessSettingsChange, response: Response, engine: Engine, visitor: CurrentVisitor, match: IfMatch = None
) -> AccessSettings:
    """Change the settings."""
    after = settings.own_sign_offs
    with engine.begin() as writer:
        users.hold(writer, LOCAL)  # settings that were never changed have no row of their own
        before = users.own_sign_offs(writer)
        require_match(match, tag(before), "a setting")
        # A choice is stored also where it is the default, which changes once another user is invited.
        if after != users.stored_own_sign_offs(writer):
            users.set_own_sign_offs(writer, after)
            detail = {"before": before, "after": after}
            audit.note(writer, visitor, "setting.changed", users.OWN_SIGN_OFFS, detail)
        stored = users.own_sign_offs(writer)
    return _tagged(response, stored)


def _tagged(response: Response, own_sign_offs: bool) -> AccessSettings:
    response.headers["ETag"] = tag(own_sign_offs)
    return AccessSettings(own_sign_offs=own_sign_offs)


def _renewed(writer: sa.Connection, name: str, public_url: str, visitor: Visitor) -> Invitation:
    """A new link for a user who lost the first one or forgot the password. 409 for a disabled user."""
    user = _one(writer, name)
    if user.disabled is not None:
        raise RefusedError("access-conflict", f"the access of {name} is withdrawn: grant it again first")
    if user.provided:
        detail = f"{name} signs in through the provider, which also renews forgotten passwords: there is no link"
        raise RefusedError("access-conflict", detail)
    code = users.renew(writer, name, visitor.account)
    audit.note(writer, visitor, "user.link_made", name, {})
    return _link(writer, name, code, public_url)


def _one(reader: sa.Connection, name: str) -> User:
    """A user, or 404."""
    found = next((row for row in users.users(reader) if row.name == name), None)
    if found is None:
        raise not_found("user", name)
    return _user(found)


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
