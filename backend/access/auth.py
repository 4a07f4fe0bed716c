"""Authorisation: who may call which route, by the table in `backend.access.rules`.

A browser authenticates with a session cookie, a program with `Authorization: Bearer` (RFC 6750). Writes and sockets
must come from the service's own pages (RFC 6454, Origin), or from a frame of theirs by its key, see
`backend.access.frames`.
"""

from __future__ import annotations

import urllib.parse
from functools import partial
from typing import Annotated

from fastapi import Depends, Request
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from backend.access.door import Door
from backend.access.frames import OPAQUE, Frames, Voucher
from backend.access.rates import Rates
from backend.access.routes import Rules
from backend.access.rules import Rule
from backend.access.shares import Shares, of_one
from backend.db import users
from backend.db.access import Visitor
from backend.db.roles import has_role, has_scope
from backend.http import forms, pages
from backend.http.errors import RefusedError, refuse

SAFE = frozenset({"GET", "HEAD", "OPTIONS"})


class Guard:
    """Accepts authenticated clients, as `request.state.visitor`; refuses all others."""

    def __init__(self, app: ASGIApp, door: Door, most: int, rates: Rates, frames: Frames) -> None:
        """most: maximum number of concurrent requests and sockets of one user; rates: of one user."""
        self.app, self.door, self.rates, self.frames = app, door, rates, frames
        self._open, self._rates_of_one = Shares("requests", most), Rates(of_one(rates.per_minute))

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        rules: Rules = scope["app"].state.rules
        connection, rule = HTTPConnection(scope), rules.of(scope)
        if rule.role is None:
            foreign = _foreign(scope, required=False)
            await (self.app if foreign is None else partial(refuse, foreign, scope["path"]))(scope, receive, send)
            return
        voucher = await self._voucher(scope, connection, rule)
        visitor = await self.door.visitor(connection) if voucher is None else voucher.visitor
        refused = _refusal(scope, visitor, rule, voucher is None) or self._too_many(visitor)
        if refused is None:
            assert visitor is not None, "a request without a visitor is refused"
            still = partial(self.door.still, connection) if voucher is None else voucher.still
            too_many = partial(self._too_many, visitor)
            scope.setdefault("state", {}).update(visitor=visitor, still=still, too_many=too_many)
            with self._open.entered(visitor):
                await self.app(scope, receive, send)
        elif scope["type"] == "http" and refused.status == 401 and pages.wants_page(connection.headers):
            passwords = await self.door.ask(users.with_passwords)
            provider = scope["app"].state.settings.oidc_name_shown
            page = forms.sign_in(401, passwords, forms.address_of(scope), provider=provider)
            await page(scope, receive, send)
        else:
            await refuse(refused, scope["path"], scope, receive, send)

    async def _voucher(self, scope: Scope, connection: HTTPConnection, rule: Rule) -> Voucher | None:
        """Who opened the frame that a request comes from; never found by a cookie, which such a frame does not send."""
        if not rule.framed or connection.headers.get("origin") != OPAQUE:
            return None
        return await self.frames.voucher(scope["path"])

    def _too_many(self, visitor: Visitor | None) -> RefusedError | None:
        if visitor is None:
            return None
        limits = (("this session or token has", self._rates_of_one, visitor.key),
                  ("your sessions and tokens have", self.rates, visitor.account))  # fmt: skip
        for sender, rates, key in limits:
            if wait := rates.wait(key):
                detail = f"{sender} sent {rates.per_minute:,} requests in a minute, the limit: try again in {wait} s"
                return RefusedError("too-many-requests", detail, headers={"Retry-After": str(wait)})
        full = self._open.full(visitor)
        return too_many(full) if full else None


def too_many(full: str) -> RefusedError:
    """429 for a limit of what is open."""
    return RefusedError("too-many-requests", f"{full}: wait for one to end", headers={"Retry-After": "1"})


def _refusal(scope: Scope, visitor: Visitor | None, rule: Rule, foreign: bool = True) -> RefusedError | None:
    """foreign: whether the header Origin counts."""
    if visitor is None:
        return _not_signed_in(Headers(scope=scope).get("authorization", ""))
    required = scope["type"] == "websocket" and visitor.via != "token"
    return (_foreign(scope, required) if foreign else None) or forbidden(visitor, rule)


def _not_signed_in(authorization: str) -> RefusedError:
    """401 by what was sent; which of the reasons holds for a token stays open."""
    scheme = authorization.partition(" ")[0]
    challenge = 'Bearer realm="clearance"'
    if not scheme:
        detail = (
            "sign in first: open the login link that `clearance serve` printed (a new one: `clearance login-link`), "
            "sign in with your password at /login, or send an API token as `Authorization: Bearer TOKEN` "
            "(`clearance token create NAME`)"
        )
    elif scheme.lower() != "bearer":  # which may be a token alone, and is not repeated
        detail = (
            "the header Authorization has another scheme than Bearer: send an API token as "
            "`Authorization: Bearer TOKEN`; `clearance token create NAME` makes one"
        )
    else:
        detail = "the API token is not valid here: unknown, expired or revoked; `clearance token create NAME` makes one"
        challenge += ', error="invalid_token"'
    return RefusedError("not-signed-in", detail, headers={"WWW-Authenticate": challenge})


def forbidden(visitor: Visitor, rule: Rule) -> RefusedError | None:
    """The reason why the rule does not permit a visitor's request: the role, or the token's scope."""
    if rule.role is not None and not has_role(visitor.role, rule.role):
        detail = (
            f"this needs the role {rule.role}, and {visitor.account} has the role {visitor.role}: "
            "an administrator can change it"
        )
        return RefusedError("role-too-low", detail)
    if visitor.scope is None:
        return None
    if rule.scope is None:
        return RefusedError("scope-too-narrow", "API tokens cannot do this: sign in with a browser")
    if not has_scope(visitor.scope, rule.scope):
        detail = (
            f"this needs a token with the scope {rule.scope}, and the token {visitor.user!r} has the scope "
            f"{visitor.scope}: use another token"
        )
        return RefusedError("scope-too-narrow", detail)
    return None


def _foreign(scope: Scope, required: bool) -> RefusedError | None:
    headers = Headers(scope=scope)
    if (scope["type"] != "websocket" and scope["method"] in SAFE) or _from_our_pages(scope, headers, required):
        return None
    detail = (
        f"the request comes from {headers.get('origin', 'no Origin')!r}, not from a page of "
        f"{headers.get('host', '')!r}: writes and sockets are accepted from the service's own pages only"
    )
    return RefusedError("foreign-origin", detail)


def _from_our_pages(scope: Scope, headers: Headers, required: bool) -> bool:
    """Browsers send Origin with every write and socket; a client that does not send it is not a browser.

    A page of the same host is ours if it came encrypted, or if this host is not called encrypted: without a trusted
    proxy the service does not see how the browser called it.
    """
    origin = headers.get("origin")
    if origin is None:
        return not required
    scheme, _, host = origin.partition("://")
    if host != headers.get("host", "") or not host:
        return False
    return scheme == "https" or (scheme == "http" and not _is_encrypted(scope, host))


def _is_encrypted(scope: Scope, host: str) -> bool:
    """Whether browsers call the service by HTTPS under this name."""
    public = urllib.parse.urlsplit(scope["app"].state.settings.public_url)
    return scope.get("scheme") in ("https", "wss") or (
        public.scheme == "https" and public.netloc.removesuffix(":443") == host.removesuffix(":443")
    )


async def visitor(request: Request) -> Visitor:
    """The authenticated visitor. A coroutine, because FastAPI runs plain functions in the thread pool."""
    found = request.state.visitor
    assert isinstance(found, Visitor)
    return found


CurrentVisitor = Annotated[Visitor, Depends(visitor)]
