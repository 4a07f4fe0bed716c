"""The service while its PostgreSQL server is away at start: alive, not ready, and 503 with a sentence for all else.

A service that is restarted instead would look like one that crashes, and its own address would refuse connections.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from socket import socket

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.responses import JSONResponse, Response
from starlette.routing import Mount
from starlette.types import Receive, Scope, Send

from backend.db.availability import PAUSE, awaited, sentence
from backend.db.outages import DatabaseOutage
from backend.http.errors import RefusedError, respond
from backend.http.outage import AGAIN, answer
from backend.middleware.edge import Edge
from backend.middleware.frame import Frame
from backend.middleware.hosts import HEALTH, Hosts
from backend.middleware.proxy import Proxied
from backend.settings import Settings
from campaigns import Problem

LIVE, READY = (frozenset(path for path in HEALTH if path.endswith(end)) for end in ("/live", "/ready"))
LATER = 1013
"""The code of a socket that is closed: try again later."""

_log = logging.getLogger("clearance")


class Waiting:
    """Answers until the database does."""

    def __init__(self, outage: DatabaseOutage) -> None:
        self.outage: DatabaseOutage | None = outage
        """Why it waits; None once it need not."""

    def app(self, settings: Settings) -> Starlette:
        hosts = Hosts(settings.host, settings.public_url, settings.allowed_hosts, settings.allow_any_host)
        found = Starlette(
            routes=[Mount("/", app=self)],
            middleware=[
                Middleware(Proxied, root=settings.root, trusted=settings.trusted),
                Middleware(Frame, encrypted=settings.encrypted),
                Middleware(Edge, hosts=hosts),
            ],
        )
        found.state.settings = settings
        return found

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": LATER})
        else:
            await self._answer(scope)(scope, receive, send)

    def _answer(self, scope: Scope) -> Response:
        path, outage = scope["path"], self.outage
        if path in LIVE:
            return JSONResponse({"status": "ok"})
        if outage is None:  # it is about to serve
            return respond(RefusedError("busy", "the service is starting", headers={"Retry-After": "1"}), path)
        if path in READY:
            after, problem = {"Retry-After": str(AGAIN[outage.kind])}, Problem(outage.kind, "", outage.sentence)
            return respond(RefusedError("not-ready", outage.sentence, [problem], headers=after), path)
        return answer(outage, scope)


def until_it_answers(
    settings: Settings, outage: DatabaseOutage, listening: socket, server: Callable[[Starlette], uvicorn.Server]
) -> bool:
    """Serve on the socket, which stays open, until the database is migrated; false if a signal came before.

    Raises what waiting does not mend.
    """
    waiting = Waiting(outage)
    serving = server(waiting.app(settings))
    asyncio.run(_serve(waiting, serving, settings.database_url, listening))
    return waiting.outage is None


async def _serve(waiting: Waiting, server: uvicorn.Server, url: str, listening: socket) -> None:
    looking = asyncio.create_task(_look(waiting, server, url))
    await server.serve([listening.dup()])  # it closes what it is given
    if not looking.done():
        looking.cancel()
        return
    looking.result()


async def _look(waiting: Waiting, server: uvicorn.Server, url: str) -> None:
    try:
        while waiting.outage is not None:
            _log.warning("%s", sentence(waiting.outage))
            await asyncio.sleep(PAUSE)
            waiting.outage = await asyncio.to_thread(awaited, url)
    finally:
        server.should_exit = True
