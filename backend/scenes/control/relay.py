"""Carries a browser's socket to a viser server of its own on loopback, and ends that server with the socket.

viser has no login and no Origin check, so its server takes nobody but this relay, known by a secret; and its public
share tunnel is closed. Two private names of viser are used for that: its version is pinned. Start reading at `relay`.
"""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import secrets
from collections.abc import Callable
from typing import Any

import rich
import viser
import websockets
from anyio import to_thread
from starlette.websockets import WebSocket, WebSocketDisconnect
from viser import _messages

from backend.scenes.control import wakeful
from backend.scenes.viewer import Viewer

SECRET = "X-Clearance-Relay"
GOING_AWAY = 1001
rich.reconfigure(quiet=True)  # viser prints a banner for every server, whatever it is told
assert viser.__version__ == "1.1.1", "the private names used here are those of viser 1.1.1"
wakeful.install()


def open_server(secret: str) -> viser.ViserServer:
    """A viser server on a free loopback port that takes only connections with the secret in their header."""
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


async def relay(
    socket: WebSocket,
    build: Callable[[viser.ViserServer], Viewer],
    opened: Callable[[Viewer], None],
    stopping: asyncio.Event,
) -> None:
    """Serve one viewer until its browser goes or the service stops, and clear everything away.

    `opened` is called with it once its browser has it.
    """
    secret = secrets.token_urlsafe(32)
    server: viser.ViserServer | None = None
    viewer: Viewer | None = None
    try:
        server = await to_thread.run_sync(open_server, secret)
        viewer = await to_thread.run_sync(build, server)
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
            await _carry(socket, back, stopping)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):  # the browser closed it
            await socket.close(GOING_AWAY)
    finally:
        if viewer is not None:
            await to_thread.run_sync(viewer.close)
        if server is not None:
            await to_thread.run_sync(server.stop)


async def _carry(socket: WebSocket, back: websockets.ClientConnection, stopping: asyncio.Event) -> None:
    """Both directions, until either end closes or the service stops."""

    async def up() -> None:
        while (message := await socket.receive())["type"] != "websocket.disconnect":
            await back.send(message.get("bytes") or message.get("text") or b"")

    async def down() -> None:
        async for message in back:
            await socket.send_bytes(message if isinstance(message, bytes) else message.encode())

    tasks = [asyncio.create_task(work) for work in (up(), down(), stopping.wait())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
