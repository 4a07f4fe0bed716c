"""GET and DELETE /session, its password, and the sessions of a user. Signing in is in `backend.sessions.entrance`."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response, status

from backend.access.auth import CurrentVisitor
from backend.db import access
from backend.http.deps import Engine, Reader, capacities
from backend.http.errors import RefusedError, problems
from backend.http.root import cookie_path
from backend.sessions import service
from backend.sessions.lockout import Lockout, seconds
from backend.sessions.schemas import BrowserSession, PasswordChange, SessionInfo

router = APIRouter(tags=["session"])

SessionId = Annotated[str, Path(pattern="^[0-9a-f]{16}$", description="The session by its id.")]


@router.get("/session")
async def get_session(visitor: CurrentVisitor) -> SessionInfo:
    """The user who is signed in."""
    return SessionInfo.model_validate(visitor, from_attributes=True)


@router.delete("/session", status_code=status.HTTP_204_NO_CONTENT)
def end_session(request: Request, engine: Engine, visitor: CurrentVisitor) -> Response:
    """Sign out this browser; an API token stays valid."""
    cookie = request.app.state.settings.cookie
    if cookie in request.cookies:
        service.close(engine, request.cookies[cookie], visitor)
    response = Response(status_code=status.HTTP_204_NO_CONTENT)
    response.delete_cookie(cookie, path=cookie_path(), httponly=True, samesite="lax")
    return response


@router.put(
    "/session/password",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=problems("wrong-password", "scope-too-narrow"),
)
async def change_password(change: PasswordChange, request: Request, engine: Engine, visitor: CurrentVisitor) -> None:
    """Change your own password; your other browsers are signed out. After wrong attempts there is a pause."""
    lockout: Lockout = request.app.state.lockout
    wait = lockout.enter(visitor.account, "")
    if wait:
        detail = f"too many wrong passwords: try again in {seconds(wait)} s"
        raise RefusedError("too-many-requests", detail, headers={"Retry-After": str(seconds(wait))})
    current = None if change.current is None else change.current.get_secret_value()
    new = change.new.get_secret_value()
    hashing = capacities(request).passwords
    try:
        await hashing.run(visitor.account, lambda: service.change_password(engine, current, new, visitor))
    except RefusedError as error:
        if error.status == 503:
            lockout.not_compared(visitor.account, "")
        raise
    lockout.succeeded(visitor.account, "")


@router.get("/sessions")
def list_sessions(request: Request, visitor: CurrentVisitor, reader: Reader) -> list[BrowserSession]:
    """The browsers that are signed in as you, newest first; for administrators those of all users."""
    rows = access.sessions(reader, None if visitor.sees_all else visitor.account)
    own = visitor.key[: access.SESSION_ID]
    used = request.app.state.door.last_uses()
    return [
        BrowserSession(**row._mapping, last_used=used.get(row.id), current=visitor.scope is None and row.id == own)
        for row in rows
    ]


@router.delete("/sessions/{session}", status_code=status.HTTP_204_NO_CONTENT, responses=problems("not-found"))
def revoke_session(session: SessionId, engine: Engine, visitor: CurrentVisitor) -> None:
    """Sign another browser out."""
    service.revoke(engine, session, visitor)
