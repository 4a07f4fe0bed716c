"""Connections that wait, of one address and of many, keep no others out."""

from __future__ import annotations

import contextlib
import logging
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from backend.http.networks import network
from backend.middleware import connections, doors
from backend.middleware.doors import Doors
from tests.api.conftest import Fresh, running
from tests.given.floods import STRANGERS
from tests.given.problem_documents import problem
from tests.given.service import Service, until

MOST, EACH = 6, 4
PATIENCE = 0.4
LONG = {"a socket with a long path": b"414", "a socket with a long header": b"431"}
HEALTH = b"GET /api/v1/health HTTP/1.1\r\nHost: localhost\r\n\r\n"
AHEAD = ("half a body after a request", "many requests at once")
WAITING = [kind for kind in STRANGERS if "socket" not in kind and kind not in AHEAD]
"""Those for whose rest the service waits."""


@pytest.fixture(scope="module")
def narrow(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with room for few connections, which waits long enough for a test."""
    with running(
        fresh_sqlite, tmp_path_factory.mktemp("narrow"), max_connections=MOST, max_connections_each=EACH
    ) as service:
        yield service


@pytest.fixture(scope="module")
def hasty(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with little patience."""
    with running(fresh_sqlite, tmp_path_factory.mktemp("hasty"), request_patience=PATIENCE) as service:
        yield service


@contextlib.contextmanager
def opened(service: Service, source: str = "127.0.0.1") -> Iterator[socket.socket]:
    with socket.create_connection(("127.0.0.1", service.port), 20, (source, 0)) as connection:
        yield connection


def rest(connection: socket.socket) -> bytes:
    received = b""
    with contextlib.suppress(ConnectionError):
        while part := connection.recv(65536):
            received += part
    return received


def answered(service: Service, sent: bytes = HEALTH, source: str = "127.0.0.1") -> bytes:
    """The beginning of the answer to a request."""
    with opened(service, source) as connection:
        connection.sendall(sent)
        return connection.recv(65536)[:13]


def held(service: Service, stack: contextlib.ExitStack, kind: str, count: int, source: str = "127.0.0.1") -> None:
    """Open so many connections that send this, each read before the next one."""
    there = service.server.server_state.connections
    for _ in range(count):
        one = stack.enter_context(opened(service, source))
        one.sendall(STRANGERS[kind].encode())
        port = one.getsockname()[1]
        if STRANGERS[kind]:
            until(lambda port=port: any(_is_read(c, port) for c in list(there)))


def _is_read(connection: Any, port: int) -> bool:
    if connection.client is None or connection.client[1] != port:
        return False
    return connection.conn.trailing_data[0] != b"" or connection.cycle is not None


@pytest.mark.parametrize("kind", WAITING)
def test_who_waits_keeps_nobody_of_the_same_address_out(narrow: Service, kind: str) -> None:
    with contextlib.ExitStack() as stack:
        held(narrow, stack, kind, 3 * MOST)
        assert answered(narrow) == b"HTTP/1.1 200 "
        assert answered(narrow, b"GET /login HTTP/1.1\r\nHost: localhost\r\n\r\n") == b"HTTP/1.1 200 "
        assert len(narrow.server.server_state.connections) <= EACH


def test_half_a_body_is_not_waited_for_and_costs_the_application_nothing(
    hasty: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    entered = []
    inside = hasty.app.middleware_stack

    async def counted(scope: Any, receive: Any, send: Any) -> None:
        entered.append(scope["path"])
        await inside(scope, receive, send)  # type: ignore[misc]

    monkeypatch.setattr(hasty.app, "middleware_stack", counted)
    with opened(hasty) as connection:
        connection.sendall(STRANGERS["half a body of /login"].encode())
        assert rest(connection) == b""
    assert answered(hasty) == b"HTTP/1.1 200 "
    assert entered == ["/api/v1/health"]


@pytest.mark.parametrize("kind", AHEAD)
def test_whoever_sends_ahead_has_one_answer(narrow: Service, kind: str) -> None:
    with opened(narrow) as connection:
        connection.sendall(STRANGERS[kind].encode())
        assert rest(connection).count(b"HTTP/1.1 ") == 1


def test_a_body_is_asked_for_where_the_client_waits(narrow: Service) -> None:
    with opened(narrow) as connection:
        connection.sendall(STRANGERS["Expect: 100-continue"].encode())
        assert connection.recv(65536).startswith(b"HTTP/1.1 100 ")
        connection.sendall(b"name=ada&password=" + b"x" * (1000 - 18))
        assert connection.recv(65536).startswith(b"HTTP/1.1 4")


@pytest.mark.parametrize("size", [10_000, 150_000])
def test_a_body_in_pieces_arrives_whole(narrow: Service, size: int) -> None:
    text = "# " + "x" * size
    with narrow.signed_in() as client:
        answer = client.post(
            "/api/v1/drafts", content=iter([b'{"name": "", "text": "', text.encode(), b'"}']),
            headers={"content-type": "application/json"},
        )  # fmt: skip
    assert (answer.status_code, answer.json()["text"]) == (201, text)


@pytest.mark.parametrize(("kind", "status"), LONG.items())
def test_a_socket_with_a_long_line_is_refused_and_closed(hasty: Service, kind: str, status: bytes) -> None:
    with opened(hasty) as connection:
        connection.sendall(STRANGERS[kind].encode())
        answer = rest(connection)
    assert answer.startswith(b"HTTP/1.1 " + status)
    assert b"application/problem+json" in answer
    until(lambda: not hasty.server.server_state.connections)


def test_what_the_socket_protocol_cannot_read_is_closed(hasty: Service) -> None:
    more = "".join(f"X-{i}: x\r\n" for i in range(130))  # `websockets` reads 128
    with opened(hasty) as connection:
        connection.sendall(STRANGERS["half a head of a socket"].encode() + more.encode() + b"\r\n")
        assert rest(connection) == b""
    until(lambda: not hasty.server.server_state.connections)


def streams(service: Service, stack: contextlib.ExitStack, count: int, source: str = "127.0.0.1") -> httpx.Client:
    """A signed-in browser, and so many of its event streams from an address."""
    client = stack.enter_context(service.signed_in())
    name = service.settings.cookie
    sent = f"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nCookie: {name}={client.cookies[name]}\r\n\r\n".encode()
    before = service.app.state.hub.listeners
    for _ in range(count):
        stack.enter_context(opened(service, source)).sendall(sent)
    until(lambda: service.app.state.hub.listeners == before + count)
    return client


def test_an_address_has_so_many_connections_and_others_have_theirs(narrow: Service) -> None:
    with contextlib.ExitStack() as stack:
        streams(narrow, stack, EACH, "127.0.0.9")
        login = b"GET /login HTTP/1.1\r\nHost: localhost\r\n\r\n"
        assert answered(narrow, login, "127.0.0.9") == b"HTTP/1.1 503 "
        assert answered(narrow, HEALTH, "127.0.0.9") == b"HTTP/1.1 200 ", "on one of the reserve"
        assert answered(narrow, login) == b"HTTP/1.1 200 "
    until(lambda: narrow.app.state.hub.listeners == 0)


def test_who_has_most_connections_makes_room(narrow: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    until(lambda: not narrow.server.server_state.connections)
    with contextlib.ExitStack() as stack:
        monkeypatch.setattr(connections, "FEW", 1)
        first = stack.enter_context(opened(narrow, "127.0.0.2"))  # the one that is idle longest
        held(narrow, stack, "half a head", 3, "127.0.0.3")
        held(narrow, stack, "half a head", 2, "127.0.0.4")
        assert answered(narrow, source="127.0.0.5") == b"HTTP/1.1 200 "
        first.sendall(HEALTH)
        assert first.recv(65536).startswith(b"HTTP/1.1 200 ")


def test_the_reserve_answers_the_health_check_only(narrow: Service) -> None:
    with contextlib.ExitStack() as stack:
        for source in ("127.0.0.2", "127.0.0.3"):
            streams(narrow, stack, MOST // 2, source)
        until(lambda: len(narrow.server.server_state.connections) == MOST)
        idle = [stack.enter_context(opened(narrow, f"127.0.1.{i}")) for i in range(1, 60)]
        assert answered(narrow) == b"HTTP/1.1 200 "
        assert answered(narrow, b"GET /login HTTP/1.1\r\nHost: localhost\r\n\r\n") == b"HTTP/1.1 503 "
        head = STRANGERS["half a head of a socket"].encode() + b"\r\n"
        assert answered(narrow, head) == b"HTTP/1.1 503 "
        with opened(narrow) as connection:
            connection.sendall(2 * HEALTH)
            assert rest(connection).count(b"HTTP/1.1 200 ") == 1, "one health check, then it is closed"
        assert len(idle) == 59
    until(lambda: narrow.app.state.hub.listeners == 0)


def test_behind_a_trusted_proxy_the_address_of_the_client_counts(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    settings = {"max_connections_each": 2, "trusted_proxies": "127.0.0.1"}
    with running(fresh_sqlite, tmp_path, **settings) as service, contextlib.ExitStack() as stack:
        client = stack.enter_context(service.signed_in())
        for _ in range(2):
            stack.enter_context(client.stream("GET", "/api/v1/events", headers={"x-forwarded-for": "10.0.0.1"}))
        refused = client.get("/api/v1/session", headers={"x-forwarded-for": "10.0.0.7, 10.0.0.1"})
        problem(refused, 503)
        assert client.get("/api/v1/session", headers={"x-forwarded-for": "10.0.0.1, 10.0.0.2"}).status_code == 200


def test_without_one_a_header_changes_nothing(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    with running(fresh_sqlite, tmp_path, max_connections_each=2) as service, contextlib.ExitStack() as stack:
        client = stack.enter_context(service.signed_in())
        stack.enter_context(client.stream("GET", "/api/v1/events", headers={"x-forwarded-for": "10.0.0.1"}))
        stack.enter_context(client.stream("GET", "/api/v1/events", headers={"x-forwarded-for": "10.0.0.2"}))
        assert answered(service, b"GET /login HTTP/1.1\r\nHost: localhost\r\n\r\n") == b"HTTP/1.1 503 "


@pytest.mark.parametrize(
    ("address", "same"),
    [
        ("10.0.0.1", "10.0.0.1"),
        ("::ffff:10.0.0.1", "10.0.0.1"),
        ("2001:db8::1%eth0", "2001:db8::/64"),
        ("x" * 99, "x" * 64),
    ],
)
def test_addresses_of_one_client(address: str, same: str) -> None:
    assert network(address) == same


def test_a_proxy_of_any_form_is_not_limited() -> None:
    trusted = Doors(9, 1, ["10.0.0.0/8", "2001:db8::5"])
    for address in ("10.1.2.3", "2001:db8::/64", "192.0.2.1"):
        trusted.enter(address)
        trusted.enter(address)
    assert [trusted.crowded(one) for one in ("10.1.2.3", "2001:db8::/64", "192.0.2.1")] == [False, False, True]


def test_refused_connections_are_reported_by_address(
    narrow: Service, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: Callable[[], list[str]] = lambda: [r.getMessage() for r in caplog.records if r.name == doors.__name__]  # noqa: E731
    with caplog.at_level(logging.WARNING), contextlib.ExitStack() as stack:
        monkeypatch.setattr(doors, "REPORTED", 0.0)
        refusals = narrow.server.config.http.doors.refusals  # type: ignore[union-attr]
        refusals.counted.clear()  # those of other tests are reported in a minute
        refusals._reported = 0.0
        held(narrow, stack, "idle", 3 * MOST, "127.0.0.8")
        until(lambda: any(" of 127.0.0.8" in line for line in said()))


def test_so_many_addresses_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doors, "MOST_ADDRESSES", 3)
    refusals = doors.Refusals()
    refusals.counted["a"] = 1  # a report is due already
    for address in "abcdef":
        refusals.note(address)
    assert refusals.counted == {"a": 2, "b": 1, "c": 1, doors.OTHERS: 3}
