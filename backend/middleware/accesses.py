"""A line in the log for each request and socket: time, address, user, method, path, status, bytes and duration.

Without the query, which can hold secrets, and with at most 200 characters of the path, as it was sent: percent-encoded,
so that it cannot break a line. Whoever collects the log rotates it.
"""

from __future__ import annotations

import logging
import re
import time
from datetime import UTC, datetime

from starlette.types import ASGIApp, Message, Receive, Scope, Send

LONGEST = 200
_KEY = re.compile(r"/key/[^/]+")
"""The key of a view's frame, which opens it."""
_UNPRINTABLE = re.compile(r"[^!-~]")
_log = logging.getLogger("clearance.access")


class Accesses:
    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        began, status, size = time.monotonic(), 0, 0

        async def sent(message: Message) -> None:
            nonlocal status, size
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                status = message["status"]
            elif message["type"] == "websocket.accept":
                status = 101
            size += len(message.get("body") or message.get("bytes") or b"")
            await send(message)

        scope.setdefault("state", {})
        try:
            await self.app(scope, receive, sent)
        finally:
            more = {"address": (scope.get("client") or ("-",))[0], "status": status}
            _log.info("%s", _line(scope, status, size, time.monotonic() - began), extra=more)


def _line(scope: Scope, status: int, size: int, seconds: float) -> str:
    visitor = scope["state"].get("visitor")
    user = (
        "-" if visitor is None else visitor.account if visitor.token is None else f"{visitor.account}/{visitor.token}"
    )
    raw = scope.get("raw_path") or scope["path"].encode()
    path = _KEY.sub("/key/-", _UNPRINTABLE.sub("?", raw.decode("latin-1")))[:LONGEST]
    address = (scope.get("client") or ("-",))[0]
    at = datetime.now(UTC).isoformat(timespec="milliseconds")
    return f"{at} {address[:64]} {user} {scope.get('method', 'SOCKET')} {path} {status or '-'} {size} {seconds:.3f}"
