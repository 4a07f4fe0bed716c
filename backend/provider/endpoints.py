"""/login/provider begins a sign-in at the provider, /login/provider/return ends it and leads back to where it began.

A failure is a page with a sentence.
"""

from __future__ import annotations

import html
import logging
from typing import TYPE_CHECKING

from fastapi import APIRouter, Request, Response, status
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse

from backend.db.access import PROVIDER_SESSION_LIFETIME
from backend.http import forms
from backend.http.deps import Engine
from backend.http.pages import plain
from backend.http.root import at
from backend.provider import service
from backend.provider.configuration import PENDING_LIFETIME, Configured
from backend.provider.errors import SignInError
from backend.sessions.cookies import browser_of, put_session, secure

if TYPE_CHECKING:
    from backend.provider.flow import Provider

router = APIRouter(include_in_schema=False)

RETURN = "/login/provider/return"
BURST, PERIOD = 20, 3.0
"""Failures that are recorded at once, and time after which one more is [s]: clients must not fill the disk."""
_log = logging.getLogger(__name__)


@router.get("/login/provider")
async def begin(request: Request, next: str = "") -> Response:  # noqa: A002
    """Send the browser to the provider."""
    try:
        address, cookie = await _provider(request).begin(forms.own_path(next))
    except SignInError as error:
        _log.warning("a sign-in could not begin: %s", error.reason or error.sentence)
        return _failed(error, forms.own_path(next))
    response = RedirectResponse(address, status.HTTP_303_SEE_OTHER)
    response.set_cookie(
        _cookie(request),
        cookie,
        max_age=int(PENDING_LIFETIME),
        path=at("/login/provider"),
        httponly=True,
        samesite="lax",
        secure=secure(request),
    )
    return response


@router.get(RETURN)
async def finish(request: Request, engine: Engine) -> Response:
    """Accept the provider's answer: open a session, or give the reason for refusing."""
    browser = browser_of(request)
    try:
        provider, answer = _provider(request), dict(request.query_params)
        identity, back = await provider.finish(answer, request.cookies.get(_cookie(request), ""))
        role = provider.configured.role_of(identity.groups)
        secret = await run_in_threadpool(service.open_session, engine, identity, role, browser)
    except SignInError as error:
        if error.reason and not request.app.state.provider_noted.wait():
            _log.warning("a sign-in through the provider failed: %s", error.reason)
            await run_in_threadpool(service.note_failure, engine, error.reason, browser.address)
        return _forget(request, _failed(error, ""))
    response = RedirectResponse(forms.own_path(back), status.HTTP_303_SEE_OTHER)
    put_session(request, response, secret, PROVIDER_SESSION_LIFETIME)
    return _forget(request, response)


def _failed(error: SignInError, back: str) -> Response:
    link = f"{at('/login')}{f'?next={forms.quoted(back)}' if back else ''}"
    body = (
        f'<p class="wrong" role="alert">{html.escape(error.sentence)}</p>'
        f'<p><a href="{html.escape(link)}">Back to the sign-in page</a></p>'
    )
    response = plain("You are not signed in", body, error.status)
    if error.status in (502, 503):
        response.headers["Retry-After"] = "60"
    return response


def _forget(request: Request, response: Response) -> Response:
    """Remove the cookie of the sign-in: it is single-use."""
    response.delete_cookie(_cookie(request), path=at("/login/provider"), httponly=True, samesite="lax")
    return response


def _cookie(request: Request) -> str:
    return f"{request.app.state.settings.cookie}_signin"


def of(configured: Configured | None) -> Provider | None:
    """The provider; its libraries are loaded only where one is set up."""
    if configured is None:
        return None
    from backend.provider.flow import Provider

    return Provider(configured)


def _provider(request: Request) -> Provider:
    found: Provider | None = request.app.state.provider
    if found is None:
        raise SignInError("No sign-in provider is set up here.", 404)
    return found
