"""Answers requests within the service, as if each had been sent by who sent the one that names them.

Start reading at `lines`.
"""

from __future__ import annotations

import json
import logging
from collections.abc import AsyncIterator, Sequence
from urllib.parse import unquote

from fastapi import Request
from starlette.datastructures import Headers
from starlette.types import Message, Scope

from backend.access.auth import forbidden
from backend.access.routes import Rules

API = "/api/v1"

_RUN = f"{API}/runs/{{run}}"
TOGETHER = frozenset(
    {
        *(
            f"{API}/{name}"
            for name in ("session", "workers", "runs", "runs/facets", "components", "campaigns", "drafts")
        ),
        *(_RUN, f"{_RUN}/traces/{{name}}"),
        *(
            f"{_RUN}/{name}"
            for name in ("stages", "findings", "components", "traces", "evaluations", "related", "signoffs")
        ),
    }
)
"""The addresses that can be asked for together: those that pages ask for first, all of them short documents of JSON."""

_log = logging.getLogger(__name__)


async def lines(request: Request, paths: Sequence[str]) -> AsyncIterator[bytes]:
    """Two lines for each answer, in the order of the paths."""
    rules: Rules = request.app.state.rules
    for place, path in enumerate(paths):
        if place and request.state.too_many() is not None:
            return
        scope = _scope(request.scope, f"{API}{path}")
        permitted = forbidden(request.state.visitor, rules.of(scope)) is None
        if permitted and rules.path_of("GET", scope["path"]) in TOGETHER:
            answer = await _answer(scope)
            if answer is not None:
                tag, body = answer
                yield json.dumps({"path": f"{API}{path}", "etag": tag}).encode() + b"\n" + body + b"\n"


def _scope(outer: Scope, address: str) -> Scope:
    path, _, query = address.partition("?")
    asked = {"path": unquote(path), "raw_path": path.encode(), "query_string": query.encode(), "headers": []}
    return {**outer, **asked, "method": "GET"}


async def _answer(scope: Scope) -> tuple[str | None, bytes] | None:
    """The entity tag and the document; None if the request is refused or fails."""
    started: list[Message] = []
    body = bytearray()

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            started.append(message)
        body.extend(message.get("body", b""))

    try:
        await scope["app"].router(scope, receive, send)
    except Exception as error:
        # Who asks for it alone is told why, and so is the log.
        _log.debug("%s is left out of a batch: %s", scope["path"], error)
        return None
    if started[0]["status"] != 200:
        return None
    return Headers(raw=started[0]["headers"]).get("etag"), bytes(body)
