"""The login link opens a session; GET and DELETE /session show and end it."""

from __future__ import annotations

import sqlalchemy as sa
from fastapi import APIRouter, Request, Response, status
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse

from backend.access.auth import CurrentVisitor
from backend.db import access
from backend.http import pages
from backend.http.deps import Engine
from backend.sessions.schemas import SessionInfo

USER = "local"
"""The user of every login link; there are no accounts yet."""

router = APIRouter(tags=["session"])
login = APIRouter(include_in_schema=False)


@login.api_route("/login", methods=["GET", "HEAD"])
async def open_session(request: Request, engine: Engine, code: str = "") -> Response:
    """Use a login link and redirect to the runs. HEAD does not use it, because link previews send HEAD."""
    if not code or request.method == "HEAD":
        return pages.sign_in(200)
    attempts = request.app.state.attempts
    secret = await run_in_threadpool(_opened, engine, code) if await attempts.good(code) else None
    if secret is None:
        answer = pages.sign_in(429 if attempts.over else 403, "This login link is invalid or expired")
        if attempts.over:
            answer.headers["Retry-After"] = "60"
        return answer
    response = RedirectResponse("/runs", status.HTTP_303_SEE_OTHER)
    response.set_cookie(
        request.app.state.settings.cookie,
        secret,
        max_age=int(access.SESSION_LIFETIME),
        httponly=True,
        samesite="lax",
        secure=request.url.scheme == "https",
    )
    return response


def _opened(engine: sa.Engine, code: str) -> str | None:
    with engine.begin() as connection:
        return access.open_session(connection, code, USER)


@router.get("/session")
async def get_session(visitor: CurrentVisitor) -> SessionInfo:
    """The user who is signed in."""
    return SessionInfo(user=visitor.user, via=visitor.via)


@router.delete("/session", status_code=status.HTTP_204_NO_CONTENT)
def end_session(request: Request, engine: Engine) -> Response:
    """Sign out this browser; an API token stays valid."""
    cookie = request.app.state.settings.cookie
    if cookie in request.cookies:
        with engine.begin() as connection:
            access.close_session(connection, request.cookies[cookie])
    response = Response(status_code=status.HTTP_204_NO_CONTENT)
    response.delete_cookie(cookie, httponly=True, samesite="lax")
    return response
