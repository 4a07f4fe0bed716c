"""Limits on the number of connections and on the time to send, to read, and to stay connected after signing out."""

from __future__ import annotations

import contextlib
import itertools
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from backend.db.access import revoke_token
from backend.events import endpoints as events
from backend.events import hub
from backend.settings import Settings
from tests.api.conftest import Fresh, running
from tests.given.full_databases import fill
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import PROTOCOL, viewing

PATIENCE = 0.4
MOST = 6
POST = b"POST /api/v1/campaigns/check HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"


@pytest.fixture(scope="module")
def strict(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with little patience and room for few connections."""
    folder: Path = tmp_path_factory.mktemp("strict")
    with running(fresh_sqlite, folder, request_patience=PATIENCE, max_connections=MOST) as service:
        service.publish()
        yield service


def opened(service: Service) -> socket.socket:
    return socket.create_connection(("127.0.0.1", service.port), timeout=60)


def rest(connection: socket.socket) -> bytes:
    """What comes until the service closes the connection."""
    received = b""
    try:
        while part := connection.recv(65536):
            received += part
    except ConnectionResetError:
        pass
    return received


def cookie(service: Service, client: httpx.Client) -> bytes:
    name = service.settings.cookie
    return f"Cookie: {name}={client.cookies[name]}\r\n".encode()


@pytest.mark.parametrize(
    "half", [b"", b"GET / HTTP/1.1\r\nHost: localhost\r\nX-A: ", b"G"], ids=["silent", "head", "a byte"]
)
def test_a_request_that_does_not_come_is_not_waited_for(strict: Service, half: bytes) -> None:
    begun = time.monotonic()
    with opened(strict) as connection:
        connection.sendall(half)
        answer = rest(connection)
    assert PATIENCE * 0.8 < time.monotonic() - begun < 30
    assert answer.startswith(b"HTTP/1.1 408 ") if half else answer == b""


def test_a_byte_now_and_then_does_not_prolong_it(strict: Service) -> None:
    with opened(strict) as connection:
        connection.settimeout(0.02)
        closed = b""
        for byte in b"GET / HTTP/1.1\r\nHost: " + 1000 * b"x":
            connection.sendall(bytes([byte]))
            try:
                closed = connection.recv(100)
                break
            except TimeoutError:
                continue
    assert closed.startswith(b"HTTP/1.1 408 "), "all were taken, which lasts 20 s and more"


def test_a_body_that_does_not_come_is_not_waited_for(strict: Service) -> None:
    with strict.signed_in() as client, opened(strict) as connection:
        connection.sendall(POST + cookie(strict, client) + b"Content-Length: 1000\r\n\r\n{")
        assert rest(connection) == b""
        until(lambda: not strict.server.server_state.tasks)
        assert client.get("/api/v1/session").status_code == 200


def test_the_next_request_of_a_connection_has_its_own_time(strict: Service) -> None:
    with opened(strict) as connection:
        for _ in range(2):
            connection.sendall(b"GET /api/v1/health HTTP/1.1\r\nHost: localhost\r\n\r\n")
            received = b""
            while b'"ok"}' not in received:
                received += connection.recv(65536)
            assert received.startswith(b"HTTP/1.1 200 ")
        connection.sendall(b"GET /api/v1")
        assert rest(connection).startswith(b"HTTP/1.1 408 ")


def test_a_stream_outlives_that_time(strict: Service) -> None:
    with strict.signed_in() as client, client.stream("GET", "/api/v1/events") as stream:
        lines = stream.iter_lines()
        assert next(lines) == "retry: 2000"
        with opened(strict) as connection:
            rest(connection)  # an idle connection is closed meanwhile, twice
        with opened(strict) as connection:
            rest(connection)
        submit(client)
        assert "event: run" in lines


def test_a_client_that_does_not_read_is_not_waited_for(strict: Service) -> None:
    with strict.signed_in() as client, unread(strict, f"GET /view/{submit(client)}/ HTTP/1.1\r\n", client):
        held = until(lambda: waiting(strict))
        until(lambda: not held & strict.server.server_state.connections)


def unread(service: Service, head: str, client: httpx.Client) -> socket.socket:
    """A connection whose small buffers fill up, because it does not read."""
    service._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)  # connections have it from there
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    connection.connect(("127.0.0.1", service.port))
    connection.sendall(head.encode() + b"Host: localhost\r\n" + cookie(service, client) + b"\r\n")
    return connection


def test_an_event_stream_that_is_not_read_is_let_go(fresh: Fresh, tmp_path: Path) -> None:
    with running(fresh, tmp_path, request_patience=PATIENCE) as service, service.signed_in() as client:
        service.publish()
        fill(service, 400, state="queued")  # active runs are sent at once
        with unread(service, "GET /api/v1/events HTTP/1.1\r\n", client):
            held = until(lambda: waiting(service))
            until(lambda: service.app.state.hub.listeners == 0)
            until(lambda: not held & service.server.server_state.connections)


def waiting(service: Service) -> set[Any]:
    """The connections on which something waits until the client reads."""
    return {c for c in list(service.server.server_state.connections) if c.transport.get_write_buffer_size()}


@contextmanager
def unread_view(service: Service) -> Iterator[socket.socket]:
    """The socket of a 3D view that is open and never read."""
    with service.signed_in() as client:
        upgrade = (
            f"GET /view/{submit(client)}/ HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {'A' * 22}==\r\n"
            f"Sec-WebSocket-Protocol: {PROTOCOL}\r\nOrigin: http://localhost\r\n"
        )
        with unread(service, upgrade, client) as connection:
            held = until(lambda: waiting(service))
            yield connection
            until(lambda: service.app.state.viewers.open == 0)
            until(lambda: not held & service.server.server_state.connections)


def test_a_view_that_is_not_read_ends_with_the_pings(strict: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strict.server.config, "ws_ping_interval", 0.1)
    monkeypatch.setattr(strict.server.config, "ws_ping_timeout", PATIENCE)
    with unread_view(strict):
        assert strict.app.state.viewers.open == 1


def test_a_view_that_is_not_read_can_be_closed(strict: Service) -> None:
    with unread_view(strict) as connection:
        connection.sendall(b"\x81\x81\0\0\0\0x")  # a masked text, which is refused


def test_beyond_so_many_connections_there_is_a_refusal_and_one_gone_makes_room(strict: Service) -> None:
    connections = strict.server.server_state.connections
    until(lambda: not connections)
    with strict.signed_in() as client:
        streams = [opened(strict) for _ in range(MOST - 1)]
        for stream in streams:
            stream.sendall(b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n" + cookie(strict, client) + b"\r\n")
        until(lambda: strict.app.state.hub.listeners == MOST - 1)
        streams.append(opened(strict))
        streams[-1].sendall(b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n" + cookie(strict, client) + b"\r\n")
        until(lambda: strict.app.state.hub.listeners == MOST)
        with strict.visitor() as late:
            assert late.get("/api/v1/health").status_code == 200, "on one of the reserve"
            refused = late.get("/login")
            assert (refused.status_code, refused.json()["type"]) == (503, "urn:clearance:problem:busy")
            assert refused.headers["retry-after"] == "5"
            streams.pop().close()
            until(lambda: len(connections) < MOST)
            assert late.get("/login").status_code == 200
        for stream in streams:
            stream.close()
        until(lambda: strict.app.state.hub.listeners == 0)


HEALTH = b"GET /api/v1/health HTTP/1.1\r\nHost: localhost\r\n"


@pytest.mark.parametrize("sent", [HEALTH, HEALTH + b"\r\n"], ids=["half a request", "a request"])
def test_idle_clients_do_not_block_others(strict: Service, sent: bytes) -> None:
    connections = strict.server.server_state.connections
    until(lambda: not connections)
    with contextlib.ExitStack() as stack:
        idle = [stack.enter_context(opened(strict)) for _ in range(3 * MOST)]
        for one in idle:
            with contextlib.suppress(OSError):  # closed for a later one
                one.sendall(sent)
        if sent != HEALTH:  # while all wait for their responses, one more is refused
            for one in idle:
                with contextlib.suppress(OSError):
                    one.recv(65536)
            until(lambda: all(c.idle_since is not None for c in list(connections)))
        with strict.visitor() as client:
            assert client.get("/api/v1/health").status_code == 200
        assert len(connections) <= MOST


def test_proxies_and_clients_close_idle_connections_first(strict: Service) -> None:
    """Or their next request could be lost: nginx and load balancers wait for 60 s."""
    connections = strict.server.server_state.connections
    until(lambda: not connections)
    with strict.visitor() as client:
        assert client.get("/api/v1/health").status_code == 200
        (connection,) = connections
        closes = until(lambda: connection.timeout_keep_alive_task)
        assert closes.when() - connection.loop.time() > 60


def test_a_view_outlives_that_time(strict: Service) -> None:
    with strict.signed_in() as client:
        run = submit(client)
        with viewing(strict, client, f"/view/{run}/") as view:
            for _ in range(2):
                with opened(strict) as connection:
                    rest(connection)  # an idle connection is closed meanwhile
            assert view.ping().wait(5)
    until(lambda: strict.app.state.viewers.open == 0)


def test_the_limits_are_settings() -> None:
    given = {"CLEARANCE_MAX_CONNECTIONS": "50", "CLEARANCE_REQUEST_PATIENCE": "3.5", "CLEARANCE_MAX_VIEWERS_EACH": "2"}
    settings = Settings.load(given)
    assert (settings.max_connections, settings.request_patience, settings.max_viewers_each) == (50, 3.5, 2)
    with pytest.raises(ValueError, match="CLEARANCE_REQUEST_PATIENCE"):
        Settings.load({"CLEARANCE_REQUEST_PATIENCE": "0"})


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Access is checked again very often."""
    monkeypatch.setattr(events, "CHECK_PERIOD", 0.0)
    monkeypatch.setattr(hub, "HEARTBEAT", 0.05)


def ends_soon(lines: Iterator[str]) -> bool:
    """Whether the stream ends within 200 lines, which is 50 heartbeats."""
    return sum(1 for _ in itertools.islice(lines, 200)) < 200


def test_a_revoked_token_loses_its_event_stream(service: Service, soon: None) -> None:
    token = service.token("ci")
    with service.visitor(authorization=f"Bearer {token}") as program, program.stream("GET", "/api/v1/events") as stream:
        lines = stream.iter_lines()
        assert next(line for line in lines if line.startswith(":"))
        with service.engine.begin() as connection:
            revoke_token(connection, "ci")
        assert ends_soon(lines)
        problem(program.get("/api/v1/session"), 401)
    until(lambda: service.app.state.hub.listeners == 0)


def test_whoever_signs_out_loses_the_event_stream_and_others_keep_theirs(service: Service, soon: None) -> None:
    with (
        service.signed_in() as leaving,
        service.signed_in() as staying,
        leaving.stream("GET", "/api/v1/events") as ends,
        staying.stream("GET", "/api/v1/events") as lasts,
    ):
        until(lambda: service.app.state.hub.listeners == 2)
        name = service.settings.cookie
        with service.visitor(cookie=f"{name}={leaving.cookies[name]}") as same:
            assert same.delete("/api/v1/session").status_code == 204
        assert ends_soon(ends.iter_lines())
        lines = lasts.iter_lines()
        assert next(line for line in lines if line.startswith(":"))
        assert service.app.state.hub.listeners == 1
