"""The outermost middleware: security headers, a size limit on bodies, and a handler of internal errors and outages.

Pure ASGI, so that streams and sockets pass untouched. Sources: W3C CSP Level 3; OWASP HTTP Headers Cheat Sheet.
"""

from __future__ import annotations

import logging
import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.http import outage
from backend.http.errors import RefusedError, broken, respond

LARGEST_BODY = 2_000_000
"""Maximum size of a body [bytes]."""

LARGER_BODIES = {"/api/v1/requirements/files": 8_000_000}
"""The same of addresses that take files."""

CSP = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; connect-src 'self'; frame-src 'self'; manifest-src 'self'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'"
)
"""Styles may be inline because the component library writes style elements; scripts never."""

HEADERS = {
    "Content-Security-Policy": CSP,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    "Cache-Control": "no-store",
}
"""Set on every response that does not set its own."""

HSTS = {"Strict-Transport-Security": "max-age=31536000"}
"""Where the public address is one of HTTPS: browsers then never call it without encryption (RFC 6797)."""

_ANNOUNCED = re.compile(r"[0-9]{1,18}")
_log = logging.getLogger(__name__)


class Frame:
    """Adds the security headers, refuses large bodies, and answers uncaught exceptions with 500."""

    def __init__(self, app: ASGIApp, encrypted: bool) -> None:
        """encrypted: whether the public address is one of HTTPS."""
        self.app, self.headers = app, headers(encrypted)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await self._socket(scope, receive, send)
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        started = False

        async def sent(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                headers = MutableHeaders(scope=message)
                for name, value in self.headers.items():
                    headers.setdefault(name, value)
            await send(message)

        try:
            await self._limited(scope, receive, sent)
        except ClientDisconnect:
            return
        except outage.DatabaseOutage as error:  # here, because authentication within needs the database, too
            if started:
                raise
            await outage.answer(error, scope)(scope, receive, sent)
        except Exception:
            _log.exception("%s %s failed", scope["method"], scope["path"])
            if started:
                raise
            await broken(scope["path"])(scope, receive, sent)

    async def _socket(self, scope: Scope, receive: Receive, send: Send) -> None:
        """A socket that is refused is answered with 403 and the same headers."""
        accepted = "websocket.http.response" not in scope.get("extensions", {})

        async def sent(message: Message) -> None:
            nonlocal accepted
            accepted = accepted or message["type"] == "websocket.accept"
            if accepted or message["type"] != "websocket.close":
                await send(message)
                return
            headers = [(name.encode(), value.encode()) for name, value in self.headers.items()]
            await send({"type": "websocket.http.response.start", "status": 403, "headers": headers})
            await send({"type": "websocket.http.response.body", "body": b""})

        try:
            await self.app(scope, receive, sent)
        except outage.DatabaseOutage as error:
            if accepted:
                raise
            await receive()  # the handshake
            await sent({"type": "websocket.close", "code": 1013, "reason": outage.refusal(error).kind})

    async def _limited(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse by Content-Length, or by counting bytes if it is absent."""
        largest = LARGER_BODIES.get(scope["path"], LARGEST_BODY)
        announced = Headers(scope=scope).get("content-length", "")
        if _ANNOUNCED.fullmatch(announced) and int(announced) > largest:
            refused = RefusedError("too-large", _too_large(largest, f"{int(announced):,} bytes"))
            await respond(refused, scope["path"])(scope, receive, send)
            return
        taken = 0

        async def counted() -> Message:
            nonlocal taken
            message = await receive()
            taken += len(message.get("body", b""))
            if taken > largest:
                raise HTTPException(413, _too_large(largest, "more"))
            return message

        await self.app(scope, counted, send)


def headers(encrypted: bool) -> dict[str, str]:
    return HEADERS | (HSTS if encrypted else {})


def _too_large(largest: int, size: str) -> str:
    what = "shorten the campaign" if largest == LARGEST_BODY else "export fewer requirements at a time"
    return f"a request's body is at most {largest:,} bytes, given {size}: {what}"
