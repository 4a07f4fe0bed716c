"""Answers HEAD like GET, without the body, at every address that supports GET (RFC 9110, section 9.3.2).

Pure ASGI. A stream is ended once its headers are sent.
"""

from __future__ import annotations

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send

OWN = frozenset({"/login"})
"""Addresses that handle HEAD themselves."""


class Heads:
    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["method"] != "HEAD" or scope["path"] in OWN:
            await self.app(scope, receive, send)
            return
        answered = asyncio.Event()

        async def head_only(message: Message) -> None:
            if message["type"] == "http.response.start":
                await send(message)
                await send({"type": "http.response.body", "body": b"", "more_body": False})
                answered.set()

        async def until_answered() -> Message:
            # Deliver the request once, then report a disconnect, which ends a stream.
            if not deliveries:
                deliveries.append(True)
                return {"type": "http.request", "body": b"", "more_body": False}
            await answered.wait()
            return {"type": "http.disconnect"}

        deliveries: list[bool] = []
        await self.app({**scope, "method": "GET"}, until_answered, head_only)
