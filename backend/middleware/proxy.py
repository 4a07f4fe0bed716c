"""The outermost middleware: removes the path of the public address, and believes the headers of trusted proxies only.

X-Forwarded-For and X-Forwarded-Proto are read by uvicorn's own middleware, X-Forwarded-Host here; from any other peer
they are ignored (RFC 7239, 8.1: a client can send them too). X-Forwarded-Prefix is never used: the path is a setting.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from typing import cast

from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from backend.http.root import ROOT

_FORWARDED = (b"x-forwarded-for", b"x-forwarded-proto", b"x-forwarded-host")
_HOST = re.compile(rb"[A-Za-z0-9.\-]{1,253}(:[0-9]{1,5})?|\[[0-9A-Fa-f:.]{2,45}\](:[0-9]{1,5})?")
_log = logging.getLogger(__name__)


class Proxied:
    """Presents every request as the browser sent it."""

    def __init__(self, app: ASGIApp, root: str, trusted: Sequence[str]) -> None:
        """root: the path of the public address, without a slash at its end. trusted: addresses and networks."""
        self._app, self._root = app, root
        self._believing = ProxyHeadersMiddleware(app, list(trusted))  # type: ignore[arg-type]
        self._reported = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        mark = ROOT.set(self._root)
        try:
            scope = self._below(scope)
            if self._trusts(scope):
                believing = cast(ASGIApp, self._believing)
                await believing(_with_host(scope), receive, send)
            else:
                await self._app(scope, receive, send)
        finally:
            ROOT.reset(mark)

    def _below(self, scope: Scope) -> Scope:
        """The request without the path of the public address; a proxy may have removed it already."""
        root, path = self._root, scope["path"]
        if not root or not (path == root or path.startswith(f"{root}/")):
            return scope
        raw = scope.get("raw_path") or b""
        if raw.startswith(root.encode()):
            raw = raw[len(root) :] or b"/"
        return {**scope, "path": path[len(root) :] or "/", "raw_path": raw}

    def _trusts(self, scope: Scope) -> bool:
        peer = scope["client"][0] if scope.get("client") else None
        if peer in self._believing.trusted_hosts:
            return True
        if not self._reported and any(name in _FORWARDED for name, _ in scope["headers"]):
            self._reported = True
            _log.info("X-Forwarded-* of %s is ignored: CLEARANCE_TRUSTED_PROXIES does not contain it", peer)
        return False


def _with_host(scope: Scope) -> Scope:
    """The scope with the host that the nearest proxy names: the last one, as proxies may append to those sent."""
    names = [value for name, value in scope["headers"] if name == b"x-forwarded-host"]
    host = names[-1].rpartition(b",")[2].strip() if names else b""
    if not _HOST.fullmatch(host):
        return {**scope}
    others = [(name, value) for name, value in scope["headers"] if name != b"host"]
    return {**scope, "headers": [(b"host", host), *others]}
