"""GET and POST /users, PATCH of one, new links, and the settings of access."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, status

from backend.access.auth import CurrentVisitor
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.users import service
from backend.users.schemas import AccessSettings, AccessSettingsChange, Invitation, User, UserChange, UserInvite

router = APIRouter(tags=["users"])

UserName = Annotated[str, Path(max_length=64, description="The user by name.")]


@router.get("/users")
def list_users(reader: Reader) -> list[User]:
    """All users, by name."""
    return service.listed(reader)


@router.post("/users", status_code=status.HTTP_201_CREATED, responses=problems("access-conflict"))
def invite_user(given: UserInvite, request: Request, engine: Engine, visitor: CurrentVisitor) -> Invitation:
    """Create a user and a single-use link, valid for three days, with which the user sets a password."""
    return service.invite(engine, given, request.app.state.settings.public_url, visitor)


@router.patch("/users/{user}", responses=problems("not-found", "access-conflict", "invalid"))
def change_user(user: UserName, given: UserChange, engine: Engine, visitor: CurrentVisitor) -> User:
    """Change a user's role, or withdraw or grant access; both apply at once, to tokens and open browsers, too."""
    return service.change(engine, user, given, visitor)


@router.post(
    "/users/{user}/invitation",
    status_code=status.HTTP_201_CREATED,
    responses=problems("not-found", "access-conflict"),
)
def renew_invitation(user: UserName, request: Request, engine: Engine, visitor: CurrentVisitor) -> Invitation:
    """A new link for a user to set a password; earlier unused ones become invalid."""
    return service.renew(engine, user, request.app.state.settings.public_url, visitor)


@router.get("/settings")
def get_settings(reader: Reader) -> AccessSettings:
    """The settings that administrators change while the service runs."""
    return service.settings(reader)


@router.patch("/settings")
def change_settings(given: AccessSettingsChange, engine: Engine, visitor: CurrentVisitor) -> AccessSettings:
    """Change the settings."""
    return service.change_settings(engine, given.own_sign_offs, visitor)
