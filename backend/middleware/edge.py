"""Checks the address of every request before it is parsed: host, length, characters, number of parameters.

Sources: RFC 9110, 15.5.15 (414); RFC 3986.
"""

from __future__ import annotations

import urllib.parse

from starlette.types import ASGIApp, Receive, Scope, Send

from backend.http.errors import RefusedError, refuse
from backend.middleware.hosts import Hosts

LONGEST = 16_000
"""Maximum of path and query [bytes]; the longest request of the pages has 5,000: a reason in encoded emoji."""

MOST_PARAMETERS = 200
"""Maximum number of parameters of a query."""


class Edge:
    """Refuses invalid addresses before the database is queried."""

    def __init__(self, app: ASGIApp, hosts: Hosts) -> None:
        self.app, self.hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        refused = self.hosts.refusal(scope) if scope["type"] in ("http", "websocket") else None
        if refused is None and scope["type"] == "http":
            refused = _refusal(scope)
        if refused is None:
            await self.app(scope, receive, send)
        else:
            await refuse(refused, scope["path"][:200].replace("\0", "\\0"), scope, receive, send)


def _refusal(scope: Scope) -> RefusedError | None:
    path, query = scope["path"], scope["query_string"]
    length = len(scope.get("raw_path") or path) + len(query)
    if length > LONGEST:
        detail = f"path and query have at most {LONGEST:,} bytes together, given {length:,}"
        return RefusedError("too-long", detail)
    parameters = query.count(b"&") + 1
    if parameters > MOST_PARAMETERS:
        detail = f"a query has at most {MOST_PARAMETERS} parameters, given {parameters:,}: ask in several requests"
        return RefusedError("bad-request", detail)
    if not path.startswith("/api/"):
        return None
    if "\0" in path:
        return RefusedError("not-found", "an address must not contain null characters (%00)")
    if b"\0" in urllib.parse.unquote_to_bytes(query):
        return RefusedError("invalid-request", "a query must not contain null characters (%00): remove them")
    return None
