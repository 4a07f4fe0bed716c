"""GET and POST /users, GET and PATCH of one, new links, and the settings of access."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.http.matches import TAGGED, IfMatch
from backend.users import service
from backend.users.schemas import AccessSettings, AccessSettingsChange, Invitation, User, UserChange, UserInvite

router = APIRouter(tags=["users"])

MADE = problems("access-conflict", *ONCE)
RENEW = "make a new link with another key; the earlier one becomes invalid"

UserName = Annotated[str, Path(max_length=64, description="The user by name.")]


@router.get("/users")
def list_users(reader: Reader) -> list[User]:
    """All users, by name."""
    return service.listed(reader)


@router.post("/users", status_code=status.HTTP_201_CREATED, responses=MADE)
def invite_user(invitation: UserInvite, request: Request, once: OnceOnly, visitor: CurrentVisitor) -> Invitation:
    """Create a user and a single-use link, valid for three days, with which the user sets a password."""
    address, name = request.app.state.settings.public_url, invitation.name.strip().lower()
    made = f"the invitation of {name}"
    return once.do_secretly(lambda writer: service.invite(writer, invitation, address, visitor), made, RENEW)


@router.get("/users/{user}", responses=TAGGED | problems("not-found"))
def get_user(user: UserName, response: Response, reader: Reader) -> User:
    """One user."""
    found = service.one(reader, user)
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
    changed = service.change(engine, user, change, visitor, match)
    response.headers["ETag"] = changed.etag
    return changed


@router.post(
    "/users/{user}/invitation",
    status_code=status.HTTP_201_CREATED,
    responses=MADE | problems("not-found"),
)
def renew_invitation(user: UserName, request: Request, once: OnceOnly, visitor: CurrentVisitor) -> Invitation:
    """A new link for a user to set a password; earlier unused ones become invalid."""
    address, made = request.app.state.settings.public_url, f"a link for {user}"
    return once.do_secretly(lambda writer: service.renew(writer, user, address, visitor), made, RENEW)


@router.get("/settings", responses=TAGGED)
def get_settings(response: Response, reader: Reader) -> AccessSettings:
    """The settings that administrators change while the service runs."""
    found = service.settings(reader)
    response.headers["ETag"] = service.etag(found)
    return found


@router.patch("/settings", responses=TAGGED | problems("changed"))
def change_settings(
    settings: AccessSettingsChange, response: Response, engine: Engine, visitor: CurrentVisitor, match: IfMatch = None
) -> AccessSettings:
    """Change the settings."""
    changed = service.change_settings(engine, settings.own_sign_offs, visitor, match)
    response.headers["ETag"] = service.etag(changed)
    return changed
