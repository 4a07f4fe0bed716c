"""Limits that uvicorn lacks: the number of open connections, and the time a client may take to send or to read.

A subclass of uvicorn's HTTP/1.1 protocol; that of WebSockets is in `backend.middleware.sockets`. A
connection for which the service waits (no request, half a request, an unread response) is closed where a limit needs
its room. Source: OWASP Denial of Service Cheat Sheet, slow HTTP attacks.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from typing import Any

import h11
from uvicorn._types import ASGI3Application, ASGIReceiveCallable, ASGISendCallable, Scope
from uvicorn.protocols.http.flow_control import CLOSE_HEADER, HIGH_WATER_LIMIT
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

from backend.http.networks import network
from backend.middleware.doors import Doors
from backend.middleware.hosts import HEALTH

RESERVE = 16
"""Connections above the maximum, on which only the health check is answered."""

RESERVED_PATIENCE = 2.0
"""Time within which its request must arrive there [s]."""

LONGEST_LINE = 8000
"""Maximum of a line of a socket's request [bytes]; `websockets` reads 8192 and answers nothing to more."""

FEW = 8
"""Addresses with at most so many connections are alike when one is closed."""

_FULL = "the maximum number of connections is open, in total or of your address: try again in a few seconds"
_SLOW = "the request did not arrive in time"
_UNREADABLE = "the request is not HTTP/1.1: its head cannot be read"
_LONG = f"a line of the request has more than {LONGEST_LINE:,} bytes, which is the limit for sockets"
_RETRY = "5"
_KINDS = {
    400: ("bad-request", "Bad Request"),
    408: ("request-timeout", "Request Timeout"),
    414: ("too-long", "URI Too Long"),
    431: ("too-long", "Request Header Fields Too Large"),
    503: ("busy", "Service Unavailable"),
}


def bounded(doors: Doors, patience: float, headers: Mapping[str, str]) -> type[H11Protocol]:
    """The protocol; `patience` limits the time to send a request or to read on [s].

    headers: of the responses that the application does not make.
    """
    return type("Bounded", (BoundedProtocol,), {"doors": doors, "patience": patience, "own_headers": headers})


class BoundedProtocol(H11Protocol):
    """Closes a connection if its request is not complete in time, or its client does not read the response."""

    doors: Doors
    patience: float
    own_headers: Mapping[str, str]
    address: str

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._sending: asyncio.TimerHandle | None = None
        self._reading: asyncio.TimerHandle | None = None
        self._upgraded = self._reserved = self._queued = self._left = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self.app = self._once_sent(self.app)
        self.address = network(self.client[0] if self.client else "")
        self.doors.enter(self.address)
        if self.doors.crowded(self.address):
            self._make_room(self.address)
        if len(self.connections) > self.doors.most:
            self._make_room()
        if not self.doors.crowded(self.address) and len(self.connections) <= self.doors.most:
            self._await_request()
        elif (
            self.doors.of(self.address) <= self.doors.each + RESERVE
            and len(self.connections) <= self.doors.most + RESERVE
        ):
            self._reserved, self.app = True, self._only_health(self.app)
            self.patience = min(self.patience, RESERVED_PATIENCE)
            self._await_request()
        else:
            self._refuse()

    def handle_events(self) -> None:
        """Handle the events of requests, including those that arrived in one piece with an earlier one."""
        super().handle_events()
        if self._upgraded or self.transport.is_closing():
            return
        if self._sent_ahead:
            self.cycle.keep_alive = False
        if self._is_awaited:
            if self._sending is None:
                self._await_request()
        else:
            self._sending = _cancelled(self._sending)

    @property
    def _is_awaited(self) -> bool:
        """Whether the client must send the rest of a request; between requests there is a longer time."""
        if self.conn.their_state is not h11.IDLE:
            return self.conn.their_state is h11.SEND_BODY
        return self.timeout_keep_alive_task is None or bool(self.conn.trailing_data[0])

    @property
    def _sent_ahead(self) -> bool:
        """Whether more was sent before the response: no browser does that, and it would keep a connection busy."""
        responding = self.cycle is not None and not self.cycle.response_complete
        return responding and self.conn.their_state is h11.DONE and bool(self.conn.trailing_data[0])

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        if len(event.target) > LONGEST_LINE:
            self._answer(414, _LONG)
        elif any(len(name) + len(value) > LONGEST_LINE for name, value in self.headers):
            self._answer(431, _LONG)
        elif self._reserved:
            self._refuse()
        else:
            self._upgraded, self._sending = True, _cancelled(self._sending)
            self._leave()  # the socket enters
            super().handle_websocket_upgrade(event)

    def connection_lost(self, exc: Exception | None) -> None:
        self._sending, self._reading = _cancelled(self._sending), _cancelled(self._reading)
        self._leave()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        super().pause_writing()
        self._reading = self._reading or self.loop.call_later(self.patience, self.transport.abort)

    def resume_writing(self) -> None:
        self._reading = _cancelled(self._reading)
        super().resume_writing()

    @property
    def idle_since(self) -> float | None:
        """Since when the service waits for the client, or the request for its turn; None while it is answered."""
        if self._reading is not None:
            return self._reading.when() - self.patience
        if self._sent_ahead:
            return 0.0
        if self._queued:
            return self.loop.time()  # after all that wait for their client
        responding = self.cycle is not None and not self.cycle.response_complete
        if responding and (self.conn.their_state is not h11.SEND_BODY or self.flow.read_paused):
            return None
        if self._sending is not None:
            return self._sending.when() - self.patience
        idle = self.timeout_keep_alive_task
        return None if idle is None or responding else idle.when() - self.timeout_keep_alive

    def _make_room(self, address: str | None = None) -> None:
        """Close the connection that has been idle longest, of this address or of those with the most connections.

        Addresses with a few connections are alike: a browser has six.
        """
        others = [c for c in self.connections if isinstance(c, BoundedProtocol) and c is not self]
        if address is not None:
            others = [c for c in others if c.address == address]
        idle = [(-max(FEW, self.doors.of(c.address)), since, c) for c in others if (since := c.idle_since) is not None]
        if idle:
            _, _, longest = min(idle, key=lambda one: one[:2])
            longest._leave()
            self.doors.refusals.note(longest.address)
            longest.transport.abort()

    def _leave(self) -> None:
        """The connection counts no longer; it may be closing still."""
        self.connections.discard(self)
        if not self._left:
            self._left = True
            self.doors.leave(self.address)

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

    def _once_sent(self, app: ASGI3Application) -> ASGI3Application:
        """The application, once the body or its first 64 KB are there: half a body costs no work of the application."""

        async def complete(scope: Scope, receive: ASGIReceiveCallable, send: ASGISendCallable) -> None:
            cycle = self.cycle
            while cycle.more_body and len(cycle.body) <= HIGH_WATER_LIMIT and not cycle.disconnected:
                if cycle.waiting_for_100_continue:
                    self._continue(cycle)
                await cycle.message_event.wait()
                cycle.message_event.clear()
            self._queued = True
            async with self.doors.turn(self.address):
                self._queued = False
                if not cycle.disconnected:
                    cycle.message_event.set()
                    await app(scope, receive, send)

        return complete

    def _continue(self, cycle: RequestResponseCycle) -> None:
        """Ask for the body (RFC 9110, 10.1.1)."""
        cycle.waiting_for_100_continue = False
        self.transport.write(
            self.conn.send(h11.InformationalResponse(status_code=100, headers=[], reason="Continue")) or b""
        )

    def _only_health(self, app: ASGI3Application) -> ASGI3Application:
        """The application, which answers one health check."""
        paths = HEALTH | {f"{self.doors.root}{path}" for path in HEALTH}

        async def reserved(scope: Scope, receive: ASGIReceiveCallable, send: ASGISendCallable) -> None:
            if scope["type"] == "http" and scope["path"] in paths:
                scope["headers"] = [*scope["headers"], CLOSE_HEADER]  # uvicorn answers with the same
                await app(scope, receive, send)
                return
            self.doors.refusals.note(self.address)
            headers, body = self._document(503, _FULL)
            raw = [(name.encode(), value.encode()) for name, value in headers.items()]
            await send({"type": "http.response.start", "status": 503, "headers": raw, "trailers": False})
            await send({"type": "http.response.body", "body": body, "more_body": False})

        return reserved

    def _refuse(self) -> None:
        self._leave()
        self.doors.refusals.note(self.address)
        self._answer(503, _FULL)

    def _answer(self, status: int, detail: str) -> None:
        """Send a problem document without the application, and close the connection."""
        headers, body = self._document(status, detail)
        head = (
            f"HTTP/1.1 {status} {_KINDS[status][1]}",
            *(f"{name}: {value}" for name, value in headers.items()),
            "",
            "",
        )
        self.transport.write("\r\n".join(head).encode() + body)
        self.transport.close()

    def _document(self, status: int, detail: str) -> tuple[dict[str, str], bytes]:
        name, title = _KINDS[status]
        kind = f"urn:clearance:problem:{name}"
        body = json.dumps({"type": kind, "title": title, "status": status, "detail": detail}).encode()
        headers = {"Content-Type": "application/problem+json", "Content-Length": f"{len(body)}", "Connection": "close"}
        retry = {"Retry-After": _RETRY} if status in (408, 503) else {}
        return {**headers, **self.own_headers, **retry}, body


def _cancelled(timer: asyncio.TimerHandle | None) -> asyncio.TimerHandle | None:
    if timer is not None:
        timer.cancel()
    return None
