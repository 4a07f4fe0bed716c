"""Answers requests within the service, as if each had been sent by who sent the one that names them."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Sequence
from urllib.parse import unquote

from fastapi import Request
from starlette.datastructures import Headers
from starlette.types import Message, Scope

from backend.access.auth import forbidden
from backend.access.routes import Rules
from backend.http.outage import DatabaseOutage

API = "/api/v1"

_LISTS = ("session", "workers", "runs", "runs/facets", "components", "campaigns", "drafts")
_PARTS = ("", "/stages", "/findings", "/components", "/traces", "/traces/{name}", "/evaluations")
TOGETHER = frozenset(f"{API}/{name}" for name in (*_LISTS, *(f"runs/{{run}}{part}" for part in _PARTS)))
"""The addresses that can be asked for together: documents of JSON that pages ask for first."""

_log = logging.getLogger(__name__)


async def lines(request: Request, paths: Sequence[str]) -> AsyncIterator[bytes | memoryview]:
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
                yield json.dumps({"path": f"{API}{path}", "etag": tag}).encode() + b"\n"
                yield body
                yield b"\n"


def _scope(outer: Scope, address: str) -> Scope:
    path, _, query = address.partition("?")
    request_target = {"path": unquote(path), "raw_path": path.encode(), "query_string": query.encode(), "headers": []}
    return {**outer, **request_target, "method": "GET"}


async def _answer(scope: Scope) -> tuple[str | None, memoryview] | None:
    """The entity tag and the document; None if the request is refused or fails."""
    started: list[Message] = []
    body = bytearray()
    request_messages: list[Message] = [{"type": "http.request", "body": b"", "more_body": False}]

    async def receive() -> Message:
        if not request_messages:
            await asyncio.Event().wait()  # a response that listens for the end of its client listens in vain
        return request_messages.pop()

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            started.append(message)
        body.extend(message.get("body", b""))

    try:
        await scope["app"].state.alone(scope, receive, send)
    except DatabaseOutage:
        return None
    except Exception:
        _log.exception("%s failed within a batch", scope["path"])
        return None
    if started[0]["status"] != 200:
        return None
    return Headers(raw=started[0]["headers"]).get("etag"), memoryview(body)
