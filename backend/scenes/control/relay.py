"""Relays a browser's socket to its own viser server on loopback, and ends that server with the socket.

viser has no login and no Origin check, so its server accepts only this relay, which presents a secret; its public share
tunnel is disabled. A page may send only the messages listed in `allowed`. This uses two private names of viser, whose
version is pinned.
"""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import secrets
from collections.abc import Callable
from functools import partial
from typing import Any

import rich
import viser
import websockets
from anyio import to_thread
from starlette.websockets import WebSocket, WebSocketDisconnect
from viser import _messages

from backend.access.rates import Bucket
from backend.scenes.control import wakeful
from backend.scenes.control.messages import BURST, RATE, paced, refusal
from backend.scenes.control.viewers import Viewers
from backend.scenes.viewer.viewer import Viewer

SECRET = "X-Clearance-Relay"
GOING_AWAY = 1001
REFUSED = 1008
CHECK_PERIOD = 15.0
"""Interval at which the visitor's access is checked again [s]."""
rich.reconfigure(quiet=True)  # viser prints a banner for every server, which cannot be disabled
assert viser.__version__ == "1.1.1", "the private names used here are those of viser 1.1.1"
wakeful.install()


def open_server(secret: str) -> viser.ViserServer:
    """A viser server on a free loopback port that accepts only connections with the secret in their header."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    sockets: Any = server._websock_server
    sockets.unregister_handler(_messages.ShareUrlRequest)
    sockets.unregister_handler(_messages.ShareUrlDisconnect)

    async def admit(client: Any) -> None:
        connection = sockets._live_connections[client.client_id]
        if not hmac.compare_digest(connection.request.headers.get(SECRET, ""), secret):
            await connection.close(1008)

    sockets._client_connect_cb.insert(0, admit)
    return server


class RefusedMessageError(Exception):
    """A message or its sender is not allowed: the socket is closed with this reason."""


async def relay(
    socket: WebSocket,
    build: Callable[[viser.ViserServer], Viewer],
    opened: Callable[[Viewer], None],
    viewers: Viewers,
) -> None:
    """Serve one viewer until its browser disconnects or the service stops, then clean up.

    `opened` is called with the viewer once its browser is connected.
    """
    thread = partial(to_thread.run_sync, limiter=viewers.threads)
    secret = secrets.token_urlsafe(32)
    server: viser.ViserServer | None = None
    viewer: Viewer | None = None
    try:
        server = await thread(open_server, secret)
        viewer = await thread(build, server)
        async with websockets.connect(
            f"ws://127.0.0.1:{server.get_port()}/",
            subprotocols=socket.scope["subprotocols"],
            additional_headers={SECRET: secret},
            compression=None,
            max_size=None,
            ping_interval=None,
            proxy=None,
        ) as back:
            await socket.accept(subprotocol=back.subprotocol)
            opened(viewer)
            code, reason = await _carry(socket, back, viewers.stopping)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):  # the browser closed it
            await socket.close(code, reason)
    finally:
        if viewer is not None:
            await thread(viewer.close)
        if server is not None:
            await thread(server.stop)


async def _carry(socket: WebSocket, back: websockets.ClientConnection, stopping: asyncio.Event) -> tuple[int, str]:
    """Relay both ways until either end closes, access ends or the service stops; returns close code and reason."""

    async def up() -> None:
        bucket = Bucket(BURST, 1.0 / RATE)
        while (message := await socket.receive())["type"] != "websocket.disconnect":
            data = message.get("bytes") or message.get("text") or b""
            if reason := refusal(data):
                raise RefusedMessageError(reason)
            await paced(bucket)
            await back.send(data)

    async def down() -> None:
        async for message in back:
            await socket.send_bytes(message if isinstance(message, bytes) else message.encode())

    async def admitted() -> None:
        while await socket.state.still():
            await asyncio.sleep(CHECK_PERIOD)
        raise RefusedMessageError("signed out")

    tasks = [asyncio.create_task(work) for work in (up(), down(), admitted(), stopping.wait())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        ended = await asyncio.gather(*tasks, return_exceptions=True)
    refused = next((str(error) for error in ended if isinstance(error, RefusedMessageError)), None)
    return (GOING_AWAY, "") if refused is None else (REFUSED, refused)
