"""The session cookie, and what a sign-in records of a browser; shared by all kinds of signing in."""

from __future__ import annotations

import urllib.parse

from fastapi import Request, Response

from backend.http.root import cookie_path
from backend.sessions.service import Browser


def put_session(request: Request, response: Response, secret: str, lifetime: float) -> None:
    response.set_cookie(
        request.app.state.settings.cookie,
        secret,
        max_age=int(lifetime),
        path=cookie_path(),
        httponly=True,
        samesite="lax",
        secure=secure(request),
    )


def secure(request: Request) -> bool:
    """Whether a cookie may be sent over TLS only."""
    return request.url.scheme == "https" or _behind_tls(request, request.app.state.settings.public_url)


def browser_of(request: Request) -> Browser:
    agent = "".join(c for c in request.headers.get("user-agent", "") if c.isprintable())
    return Browser(agent[:200], "" if request.client is None else request.client.host)


def _behind_tls(request: Request, public_url: str) -> bool:
    """Whether the browser came through a proxy with TLS: by the public address, not by that of this machine."""
    public = urllib.parse.urlsplit(public_url)
    return public.scheme == "https" and public.netloc == request.headers.get("host", "")
