"""Answers in the form that a client prefers: times as RFC 3339, lists in one envelope (RFC 7240, the header Prefer).

Without the header, answers stay as they are. Only JSON that the OpenAPI document describes is changed: no file, no
stream of events, nothing inside a campaign. Pure ASGI.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from anyio import to_thread
from fastapi import FastAPI
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.http.errors import MEDIA_TYPE
from backend.http.schema import UNIX_TIME

TIMES, LISTS = "times=rfc3339", "lists=envelope"
_LATEST = 253_402_300_799.0
"""The end of the year 9999, the last of RFC 3339."""


class Preferred:
    """Buffers and rewrites the JSON answers of clients that send the header."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._operations: list[tuple[str, re.Pattern[str], dict[str, Any]]] = []

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        wanted = preferences(Headers(scope=scope)) if scope["type"] == "http" else frozenset()
        if not wanted or not scope["path"].startswith("/api/"):
            await self.app(scope, receive, send)
            return
        if not self._operations:
            await to_thread.run_sync(self._read, scope["app"])  # a second of work for the document
        await self.app(scope, receive, _Answer(self, scope, send, wanted))

    def _read(self, app: FastAPI) -> None:
        found = []
        for path, methods in sorted(app.openapi()["paths"].items(), key=lambda item: "{" in item[0]):
            pattern = re.compile(re.sub(r"\\\{\w+\\\}", "[^/]+", re.escape(path)))
            found += [(method.upper(), pattern, operation) for method, operation in methods.items()]
        self._operations = found

    def schema(self, scope: Scope) -> dict[str, Any] | None:
        for method, pattern, operation in self._operations:
            if method == scope["method"] and pattern.fullmatch(scope["path"]):
                return _described(operation)
        return None


class _Answer:
    def __init__(self, owner: Preferred, scope: Scope, send: Send, wanted: frozenset[str]) -> None:
        self.owner, self.scope, self.send, self.wanted = owner, scope, send, wanted
        self.start: Message | None = None
        self.body = b""

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            kind = Headers(raw=message["headers"]).get("content-type", "")
            plain = message["status"] < 300 and kind.startswith("application/json")
            if plain and self.owner.schema(self.scope) is not None:
                self.start = message
                return
        elif self.start is not None:
            self.body += message.get("body", b"")
            if message.get("more_body"):
                return
            message = await self._rewritten()
        await self.send(message)

    async def _rewritten(self) -> Message:
        schema = self.owner.schema(self.scope)
        assert self.start is not None
        assert schema is not None
        known = self.scope["app"].openapi()["components"]["schemas"]
        document = json.loads(self.body)
        if TIMES in self.wanted:
            document = with_times(document, schema, known)
        if LISTS in self.wanted and isinstance(document, list):
            document = {"items": document, "next_cursor": None}
        body = json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
        headers = MutableHeaders(raw=self.start["headers"])
        headers["content-length"] = str(len(body))
        headers["preference-applied"] = ", ".join(sorted(self.wanted))
        headers.add_vary_header("Prefer")
        await self.send({**self.start, "headers": headers.raw})
        return {"type": "http.response.body", "body": body}


def preferences(headers: Headers) -> frozenset[str]:
    """The known preferences of a request; others are ignored, as the standard has it."""
    header = ",".join(headers.getlist("prefer")).lower()
    found = {re.sub(r'["\s]', "", part.partition(";")[0]) for part in header.split(",")}
    return frozenset(found & {TIMES, LISTS})


def _described(operation: Mapping[str, Any]) -> dict[str, Any] | None:
    for status, answer in operation["responses"].items():
        schema = answer.get("content", {}).get("application/json", {}).get("schema")
        if status.startswith("2") and schema and MEDIA_TYPE not in answer["content"]:
            return dict(schema)
    return None


def with_times(value: Any, schema: Mapping[str, Any], known: Mapping[str, Any]) -> Any:
    """The value with times as text; schema: its description in the document."""
    if "$ref" in schema:
        schema = known[schema["$ref"].rsplit("/", 1)[-1]]
    options = schema.get("anyOf") or schema.get("oneOf")
    if options:
        return _chosen(value, options, known)
    if schema.get("format") == UNIX_TIME:
        return rfc3339(value)
    if isinstance(value, dict) and "properties" in schema:
        fields = schema["properties"]
        return {key: with_times(v, fields[key], known) if key in fields else v for key, v in value.items()}
    if isinstance(value, list) and isinstance(schema.get("items"), Mapping):
        return [with_times(inner, schema["items"], known) for inner in value]
    return value


def _chosen(value: Any, options: Any, known: Mapping[str, Any]) -> Any:
    """The value with its times written by the first alternative that changes it: they do not differ in times."""
    for option in options:
        found = with_times(value, option, known)
        if found != value:
            return found
    return value


def rfc3339(seconds: Any) -> Any:
    """2026-11-22T07:00:00.250000Z; what is no time of these years stays a number."""
    if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not 0.0 <= seconds <= _LATEST:
        return seconds
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")
