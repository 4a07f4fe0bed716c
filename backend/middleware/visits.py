"""Limits the concurrent requests of each client's address where a trusted proxy names it.

Connections are limited by `backend.middleware.connections`; all those of a proxy have the same address.
"""

from __future__ import annotations

from collections import Counter

from starlette.types import ASGIApp, Receive, Scope, Send

from backend.http.errors import RefusedError, refuse
from backend.http.networks import network
from backend.middleware.hosts import HEALTH


class Visits:
    def __init__(self, app: ASGIApp, each: int) -> None:
        """each: maximum number of concurrent requests and sockets of an address."""
        self.app, self.each = app, each
        self._open: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket") or not scope.get("client") or scope["path"] in HEALTH:
            await self.app(scope, receive, send)
            return
        address = network(scope["client"][0])
        if self._open[address] >= self.each:
            detail = f"{self.each} requests of your address are open, which is the limit: wait for one to end"
            refused = RefusedError("busy", detail, headers={"Retry-After": "5"})
            await refuse(refused, scope["path"], scope, receive, send)
            return
        self._open[address] += 1
        try:
            await self.app(scope, receive, send)
        finally:
            self._open[address] -= 1
            if not self._open[address]:
                del self._open[address]
