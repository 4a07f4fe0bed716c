"""Limits that uvicorn lacks: the number of open connections, and the time a client may take to send or to read.

Subclasses of uvicorn's HTTP/1.1 protocol and of its WebSocket protocol, which takes over after the upgrade. Source:
OWASP Denial of Service Cheat Sheet, slow HTTP attacks.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from typing import Any

import h11
from uvicorn._types import ASGISendEvent
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

_FULL = "the maximum number of connections is open: try again in a few seconds"
_SLOW = "the request did not arrive in time"
_UNREADABLE = "the request is not HTTP/1.1: its head cannot be read"
_RETRY = "5"
_KINDS = {
    400: ("bad-request", "Bad Request"),
    408: ("request-timeout", "Request Timeout"),
    503: ("busy", "Service Unavailable"),
}


def bounded(most: int, patience: float, headers: Mapping[str, str]) -> type[H11Protocol]:
    """The protocol for at most `most` connections; `patience` limits the time to send a request or to read on [s].

    headers: of the responses that the application does not make.
    """
    return type("Bounded", (BoundedProtocol,), {"most": most, "patience": patience, "own_headers": headers})


def bounded_socket(patience: float) -> type[WebSocketsSansIOProtocol]:
    """The WebSocket protocol; `patience` limits the time a client may take to read pending data at close [s]."""
    return type("BoundedSocket", (BoundedSocketProtocol,), {"patience": patience})


class BoundedProtocol(H11Protocol):
    """Closes a connection if its request is not complete in time, or its client does not read the response."""

    most: int
    patience: float
    own_headers: Mapping[str, str]

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._sending: asyncio.TimerHandle | None = None
        self._reading: asyncio.TimerHandle | None = None
        self._upgraded = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        if len(self.connections) <= self.most or self._made_room():
            self._await_request()
        else:
            self._answer(503, _FULL)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        if self._upgraded or self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            self._sending = _cancelled(self._sending)
        elif self._sending is None and not self.transport.is_closing():
            self._await_request()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        self._upgraded = True
        super().handle_websocket_upgrade(event)

    def connection_lost(self, exc: Exception | None) -> None:
        self._sending, self._reading = _cancelled(self._sending), _cancelled(self._reading)
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        super().pause_writing()
        self._reading = self._reading or self.loop.call_later(self.patience, self.transport.abort)

    def resume_writing(self) -> None:
        self._reading = _cancelled(self._reading)
        super().resume_writing()

    @property
    def _idle_since(self) -> float | None:
        """The time since which the service waits for a request; None while a response is due."""
        if self.cycle is not None and not self.cycle.response_complete:
            return None
        if self._sending is not None:
            return self._sending.when() - self.patience
        idle = self.timeout_keep_alive_task
        return None if idle is None else idle.when() - self.timeout_keep_alive

    def _made_room(self) -> bool:
        """Close the connection that has been idle longest, so that idle clients do not keep others out."""
        idle = [(c._idle_since, c) for c in self.connections if isinstance(c, BoundedProtocol) and c is not self]
        waiting = [(since, c) for since, c in idle if since is not None]
        if not waiting:
            return False
        _, longest = min(waiting, key=lambda one: one[0])
        self.connections.discard(longest)
        longest.transport.abort()
        return True

    def _await_request(self) -> None:
        self._sending = self.loop.call_later(self.patience, self._too_slow)

    def _too_slow(self) -> None:
        self._sending = None
        if self.flow.read_paused:  # the service itself has paused reading
            self._await_request()
        elif self.conn.their_state is h11.IDLE and self.conn.trailing_data[0]:
            self._answer(408, _SLOW)
        else:  # no request, or an incomplete body, whose reader is informed of the disconnect
            self.transport.close()

    def send_400_response(self, msg: str) -> None:
        """uvicorn's own is plain text without headers."""
        self._answer(400, _UNREADABLE)

    def _answer(self, status: int, detail: str) -> None:
        """Send a problem document without the application, and close the connection."""
        name, title = _KINDS[status]
        kind = f"urn:clearance:problem:{name}"
        body = json.dumps({"type": kind, "title": title, "status": status, "detail": detail}).encode()
        headers = {"Content-Type": "application/problem+json", "Content-Length": f"{len(body)}", "Connection": "close"}
        headers |= self.own_headers
        headers |= {} if status == 400 else {"Retry-After": _RETRY}
        lines = [f"HTTP/1.1 {status} {title}", *(f"{name}: {value}" for name, value in headers.items()), "", ""]
        self.transport.write("\r\n".join(lines).encode() + body)
        self.transport.close()


class BoundedSocketProtocol(WebSocketsSansIOProtocol):
    """Closes a socket whose client does not read; uvicorn would wait until all data are read.

    uvicorn sends a ping every 20 s and closes the socket when no pong comes within 20 s.
    """

    patience: float

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


def _cancelled(timer: asyncio.TimerHandle | None) -> asyncio.TimerHandle | None:
    if timer is not None:
        timer.cancel()
    return None
