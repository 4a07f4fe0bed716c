"""The limits of `backend.middleware.connections` for WebSockets, which another protocol of uvicorn reads."""

from __future__ import annotations

from asyncio.transports import BaseTransport

from uvicorn._types import ASGISendEvent
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from backend.http.networks import network
from backend.middleware.doors import Doors


def bounded_socket(doors: Doors, patience: float) -> type[WebSocketsSansIOProtocol]:
    """The WebSocket protocol; `patience` limits the time a client may take to read pending data at close [s]."""
    return type("BoundedSocket", (BoundedSocketProtocol,), {"doors": doors, "patience": patience})


class BoundedSocketProtocol(WebSocketsSansIOProtocol):
    """Closes a socket whose client does not read; uvicorn would wait until all data are read.

    uvicorn sends a ping every 20 s and closes the socket when no pong comes within 20 s.
    """

    doors: Doors
    patience: float
    address: str

    def connection_made(self, transport: BaseTransport) -> None:
        super().connection_made(transport)
        self.address = network(self.client[0] if self.client else "")
        self.doors.enter(self.address)

    def connection_lost(self, exc: Exception | None) -> None:
        self.doors.leave(self.address)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        if not self.handshake_initiated:  # the whole request came at once, and `websockets` could not read it
            self.transport.abort()

    def keepalive_timeout(self) -> None:
        super().keepalive_timeout()
        if self.transport.get_write_buffer_size():
            self.transport.abort()

    async def send(self, message: ASGISendEvent) -> None:
        if message["type"] == "websocket.close":  # this call waits until the client reads
            self.loop.call_later(self.patience, self.transport.abort)
        if message["type"].startswith("websocket.http.response") and self.conn.eof_sent:
            return  # uvicorn has refused the handshake itself, because the service stops
        await super().send(message)
        if message["type"] == "websocket.http.response.body":  # answered: uvicorn would log it as an error
            self.handshake_complete = True
