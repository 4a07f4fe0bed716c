"""Counts requests by route and status class, with a histogram of their durations.

A histogram's buckets are cumulative, as in the text format of Prometheus.
"""

from __future__ import annotations

import bisect
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import cast

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.access.routes import Rules
from backend.access.rules import Method
from backend.metrics.text import Sample

BUCKETS = (0.005, 0.02, 0.1, 0.5, 2.0, 10.0)
"""Upper limits [s]."""
UNKNOWN = "unknown"
"""Route of addresses that the service does not have."""

Labels = tuple[str, str, str]
"""Method, route, status class."""


class Requests:
    """The requests since the start of this process; used on one event loop."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[Labels, int]] = Counter()
        self._seconds: defaultdict[Labels, float] = defaultdict(float)

    def note(self, labels: Labels, seconds: float) -> None:
        self._counts[labels, bisect.bisect_left(BUCKETS, seconds)] += 1
        self._seconds[labels] += seconds

    def samples(self) -> Iterator[Sample]:
        """The histogram's lines."""
        name = "clearance_request_seconds"
        for (method, route, status), seconds in sorted(self._seconds.items()):
            named = {"method": method, "route": route, "status": status}
            total = 0
            for index, limit in enumerate((*map(str, BUCKETS), "+Inf")):
                total += self._counts[(method, route, status), index]
                yield Sample(f"{name}_bucket", total, named | {"le": limit})
            yield Sample(f"{name}_sum", seconds, named)
            yield Sample(f"{name}_count", total, named)


class Measured:
    """Middleware that notes every request."""

    def __init__(self, app: ASGIApp, requests: Requests) -> None:
        self.app, self.requests = app, requests

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        began, status = time.monotonic(), 0

        async def sent(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, sent)
        finally:
            self.requests.note(_labels(scope, status), time.monotonic() - began)


def _labels(scope: Scope, status: int) -> Labels:
    rules: Rules = scope["app"].state.rules
    method = "GET" if scope["method"] == "HEAD" else scope["method"]
    route = rules.path_of(cast(Method, method), scope["path"])
    if route is None:  # a client may invent methods and addresses without end
        return "other", UNKNOWN, _class(status)
    return method, route, _class(status)


def _class(status: int) -> str:
    return f"{status // 100}xx" if status else "none"
