"""/login and /invite: a login link, a password or an invitation opens a session and leads on to one of our own pages.

No answer shows whether a name has an account: unknown names cost the same work, wait as long and read the same.
"""

from __future__ import annotations

import sqlalchemy as sa
from fastapi import APIRouter, Request, Response, status
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse

from backend.access.door import Door
from backend.db import access, passwords, users
from backend.http import forms
from backend.http.deps import Engine, capacities
from backend.http.errors import RefusedError
from backend.sessions import service
from backend.sessions.cookies import browser_of, put_session
from backend.sessions.failures import INVITATION, LINK
from backend.sessions.lockout import Lockout, seconds

router = APIRouter(include_in_schema=False)

WRONG = "The name or the password is wrong."


@router.api_route("/login", methods=["GET", "HEAD"])
async def open_session(request: Request, engine: Engine, code: str = "", next: str = "") -> Response:  # noqa: A002
    """Use a login link, or show the form, or lead on who is signed in already.

    HEAD does not use a link, because link previews send HEAD.
    """
    visitor = None if code else await _door(request).visitor(request)
    if visitor is not None and visitor.via != "token":
        return RedirectResponse(forms.own_path(next), status.HTTP_303_SEE_OTHER)
    if not code or request.method == "HEAD":
        return forms.sign_in(200, await _door(request).ask(users.with_passwords), next, provider=_provider(request))
    attempts = request.app.state.attempts
    good = await attempts.good(code)
    secret = await run_in_threadpool(service.open_by_link, engine, code, browser_of(request)) if good else None
    if secret is None:
        request.app.state.failures.wrong(LINK, browser_of(request).address)
        wrong = "This login link is invalid or expired"
        # Above the rate of wrong codes nothing is read for each of them.
        with_passwords = not attempts.over and await _door(request).ask(users.with_passwords)
        answer: Response = forms.sign_in(
            429 if attempts.over else 403, with_passwords, next, wrong, provider=_provider(request)
        )
        if attempts.over:
            answer.headers["Retry-After"] = "60"
        return answer
    return _signed_in(request, secret, next)


@router.post("/login")
async def sign_in(request: Request, engine: Engine) -> Response:
    """Sign in with name and password; after several failures there is a pause, which doubles."""
    fields = await forms.fields(request)
    name, back, browser = _name(fields.get("name", "")), fields.get("next", ""), browser_of(request)
    lockout: Lockout = request.app.state.lockout
    hashing = capacities(request).passwords
    hashing.refuse_full()
    wait = lockout.enter(name, browser.address)
    if wait:
        again = f"Too many failed attempts. Try again in {seconds(wait)} s."
        answer = forms.sign_in(429, True, back, wrong=again, name=name[:64], provider=_provider(request))
        answer.headers["Retry-After"] = str(seconds(wait))
        return answer
    password = fields.get("password", "")
    try:
        stored = await _door(request).ask(lambda reader: users.password_of(reader, name))
        right = await hashing.run("", lambda: passwords.matches(stored, password))
    except (RefusedError, sa.exc.SQLAlchemyError):
        lockout.not_compared(name, browser.address)
        raise
    secret = await run_in_threadpool(service.open_by_password, engine, name, browser) if right else None
    if secret is None:
        await run_in_threadpool(service.note_failure, engine, name, lockout.failures(name), browser.address)
        return forms.sign_in(403, True, back, wrong=WRONG, name=name[:64], provider=_provider(request))
    lockout.succeeded(name, browser.address)
    return _signed_in(request, secret, back)


@router.api_route("/invite", methods=["GET", "HEAD"])
async def show_invitation(request: Request, code: str = "") -> Response:
    """The form of an invitation; only sending it uses the invitation."""
    user = await _door(request).ask(lambda reader: users.invited(reader, code))
    if user is None and code:
        request.app.state.failures.wrong(INVITATION, browser_of(request).address)
    return forms.no_invitation() if user is None else forms.invitation(200, user, code)


@router.post("/invite")
async def accept_invitation(request: Request, engine: Engine) -> Response:
    """Set the password of the invited user, and sign in."""
    fields = await forms.fields(request)
    code, password = fields.get("code", ""), fields.get("password", "")
    user = await _door(request).ask(lambda reader: users.invited(reader, code))
    if user is None:
        request.app.state.failures.wrong(INVITATION, browser_of(request).address)
        return forms.no_invitation()
    wrong = passwords.problem(password, user)
    if wrong is None and password != fields.get("again", ""):
        wrong = "the two passwords differ"
    if wrong is not None:
        return forms.invitation(422, user, code, wrong[0].upper() + wrong[1:] + ".")
    hashing = capacities(request).passwords
    secret = await hashing.run("", lambda: service.accept(engine, code, password, browser_of(request)))
    return forms.no_invitation() if secret is None else _signed_in(request, secret, "")


def _signed_in(request: Request, secret: str, back: str) -> Response:
    response = RedirectResponse(forms.own_path(back), status.HTTP_303_SEE_OTHER)
    put_session(request, response, secret, access.SESSION_LIFETIME)
    return response


def _name(typed: str) -> str:
    """The name as users have it; empty for what no name can be, such as null characters."""
    name = typed.strip().lower()[:200]
    return name if name.isprintable() else ""


def _provider(request: Request) -> str:
    return str(request.app.state.settings.oidc_name_shown)


def _door(request: Request) -> Door:
    door = request.app.state.door
    assert isinstance(door, Door)
    return door
