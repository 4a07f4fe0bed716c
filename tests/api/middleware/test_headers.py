"""Security headers on every response of every route: of each status, and where no application answers.

Also the names that the service answers to, and the limits of users. One application, asked in-process; raw connections
where the protocol itself answers.
"""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.access.rules import RULES
from backend.db.tables import Run
from backend.middleware.frame import CSP, HEADERS, LARGEST_BODY
from backend.middleware.hosts import HEALTH
from backend.runs.quota import Quota
from backend.scenes.base.dress import OPENED_ALONE, SANDBOX
from backend.scenes.endpoints import CSP as VIEW
from tests.api.conftest import Fresh, running
from tests.given.busy_service import occupied
from tests.given.openapi_document import filled
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.stored_sizes import stored_size

HOST = "clearance.example"


@pytest.fixture(scope="module")
def service(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with occupied(fresh_sqlite, tmp_path_factory.mktemp("headers"), public_url=f"https://{HOST}") as service:
        (service.settings.pages / "index.html").touch()
        yield service


@pytest.fixture(scope="module")
def client(service: Service) -> Iterator[httpx.Client]:
    with service.visitor(host=HOST, authorization=f"Bearer {service.token()}") as client:
        yield client


def guarded(headers: httpx.Headers, encrypted: bool = True) -> None:
    """All security headers are there, once each; a view and a recording have a policy of their own."""
    policy = headers["content-security-policy"]
    assert policy == CSP or policy.startswith("default-src 'none'; "), policy
    for needed in ("base-uri 'none'", "frame-ancestors", "default-src 'none'", "form-action"):
        assert needed in policy
    for name in HEADERS.keys() - {"Content-Security-Policy", "Cache-Control"}:
        expected = OPENED_ALONE.get(name, HEADERS[name]) if SANDBOX in policy else HEADERS[name]
        assert headers.get_list(name) == [expected], name
    assert headers["cache-control"]
    assert headers.get("strict-transport-security") == ("max-age=31536000" if encrypted else None)
    assert "server" not in headers


ROUTES = [rule for rule in RULES if rule[0] != "SOCKET"]
"""Sockets are below."""


@pytest.mark.by_day(28)
@pytest.mark.parametrize("route", ROUTES, ids=" ".join)
def test_every_route_has_the_headers(service: Service, client: httpx.Client, route: tuple[str, str]) -> None:
    """As anonymous, with a token, under another name, and with a method that it does not have."""
    method, path = route
    named = path.replace("{run}", "R-0001").replace("{draft}", "D-0001").replace("{flight}", "F1")
    address = re.sub(r"{rest:path}", "", named) if "view" in named else named
    skipped = address.endswith(("report.pdf", "/events"))  # a browser would be started; a stream does not end
    statuses = set()
    with service.visitor(host=HOST) as anonymous, service.visitor(host="evil.example") as rebound:
        asked = [anonymous.request(method, filled(address)), rebound.request(method, filled(address))]
    asked += [] if skipped else [client.request(method, filled(address))]
    asked.append(client.request("LINK", filled(address)))
    for answer in asked:
        guarded(answer.headers)
        statuses.add(answer.status_code)
    assert asked[1].status_code == (asked[0].status_code if path in HEALTH else 421)
    assert all(status < 500 or status == 503 for status in statuses)


STATUSES: dict[int, tuple[str, str, dict[str, Any]]] = {
    307: ("GET", "/", {}),
    308: ("GET", "/view/R-0001", {}),
    400: ("GET", "/api/v1/runs?" + "&".join(["tag=x"] * 300), {}),
    404: ("GET", "/api/v1/nothing", {}),
    405: ("PUT", "/api/v1/runs", {}),
    412: ("PATCH", "/api/v1/runs/R-0001", {"json": {"name": "x"}, "headers": {"if-match": '"x"'}}),
    413: ("POST", "/api/v1/campaigns/check", {"content": b" " * (LARGEST_BODY + 1)}),
    414: ("GET", "/api/v1/runs?q=" + "x" * 20_000, {}),
    415: ("POST", "/api/v1/runs", {"content": b"x", "headers": {"content-type": "text/csv"}}),
    422: ("POST", "/api/v1/runs", {"json": {"campaign": {}}}),
}


@pytest.mark.parametrize("status", STATUSES)
def test_every_status_has_the_headers(client: httpx.Client, status: int) -> None:
    method, path, given = STATUSES[status]
    answer = client.request(method, path, **given)
    assert answer.status_code == status
    guarded(answer.headers)


def test_an_internal_error_has_the_headers_and_no_detail(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.runs.endpoints.facets", lambda reader: 1 / 0)
    answer = client.get("/api/v1/runs/facets")
    assert answer.status_code == 500
    guarded(answer.headers)
    assert "ZeroDivision" not in answer.text


@pytest.mark.parametrize(
    "raw", [b"\x00\xff nonsense\r\n\r\n", b"GET / HTTP/1.1\r\nHost localhost\r\n\r\n", b"GET /\xff HTTP/1.1\r\n\r\n"]
)
def test_what_is_not_http(service: Service, raw: bytes) -> None:
    with socket.create_connection(("127.0.0.1", service.port), timeout=10) as connection:
        connection.sendall(raw)
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    status, headers = head(b"".join(parts))
    assert status == 400
    guarded(headers)
    assert headers["content-type"] == "application/problem+json"


def head(answer: bytes) -> tuple[int, httpx.Headers]:
    lines = answer.partition(b"\r\n\r\n")[0].decode().split("\r\n")
    return int(lines[0].split()[1]), httpx.Headers([tuple(line.split(": ", 1)) for line in lines[1:]])


@pytest.mark.parametrize("name", [HOST, "evil.example"])
def test_a_socket_that_is_refused(service: Service, name: str, caplog: pytest.LogCaptureFixture) -> None:
    asked = (
        f"GET /view/R-0001/ HTTP/1.1\r\nHost: {name}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", service.port), timeout=10) as connection:
        connection.sendall(asked.encode())
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    status, headers = head(b"".join(parts))
    assert status == 403
    guarded(headers)
    assert caplog.records == [], "whoever is refused writes no log"


def directive(policy: str, name: str) -> list[str]:
    """The sources that a content security policy permits under a name."""
    (found,) = [words[1:] for words in map(str.split, policy.split(";")) if words[0] == name]
    return found


def test_the_view_may_not_call_other_servers_and_be_framed_by_our_pages_only() -> None:
    assert directive(VIEW, "connect-src") == ["'self'", "data:", "blob:"]
    assert "form-action 'none'" in VIEW
    assert "frame-ancestors 'self'" in VIEW
    assert VIEW.endswith("; sandbox allow-scripts"), "with its own origin it would have the visitor's session"


def test_without_https_there_is_no_promise_of_it(still: Service) -> None:
    with still.visitor() as anonymous:
        guarded(anonymous.get("/login").headers, encrypted=False)


def test_a_session_above_its_rate_is_refused_and_answered_after_the_stated_wait(
    fresh_sqlite: Fresh, tmp_path: Path
) -> None:
    with running(fresh_sqlite, tmp_path, max_requests_per_minute=60) as service:
        path = "/api/v1/session"
        with service.visitor(authorization=f"Bearer {service.token('one')}") as one:
            statuses = [one.get(path).status_code for _ in range(70)]
            refused = one.get(path)
            with service.visitor(authorization=f"Bearer {service.token('two')}") as two:
                others = [two.get(path).status_code for _ in range(30)]
                assert one.get("/api/v1/health").status_code == 200
    assert statuses[:48] == [200] * 48, "a session or token has four fifths of the rate of its user"
    assert (others[:10], others[-1]) == ([200] * 10, 429), "more tokens do not give more than that rate"
    assert 429 in statuses
    assert problem(refused, 429)["type"] == "urn:clearance:problem:too-many-requests"
    assert "48 requests " in str(refused.json()["detail"])
    assert int(refused.headers["retry-after"]) >= 1
    guarded(refused.headers, encrypted=False)


def test_quotas_of_a_user(fresh_sqlite: Fresh, tmp_path: Path) -> None:
    with running(fresh_sqlite, tmp_path, max_active_runs_each=2) as service, service.signed_in() as client:
        service.publish()
        token = service.token("ci")  # of the same user
        bodies = [{"campaign": campaign(seed=seed)} for seed in range(4)]
        assert client.post("/api/v1/runs", json=bodies[0]).status_code == 201
        with service.visitor(authorization=f"Bearer {token}") as program:
            assert program.post("/api/v1/runs", json=bodies[1]).status_code == 201
            refused = problem(program.post("/api/v1/runs", json=bodies[2]), 409)
        assert refused["type"] == "urn:clearance:problem:quota-reached"
        assert str(refused["detail"]).startswith("local has 2 runs ")
        assert " 1 more " in str(refused["detail"])
        sweep = {"campaign": campaign(), "path": "controller.k_p", "values": [0.05, 0.06]}
        problem(client.post("/api/v1/sweeps", json=sweep), 409)
        assert client.post("/api/v1/runs/R-0001/cancel").status_code == 200
        assert client.post("/api/v1/runs", json=bodies[2]).status_code == 201
        assert client.get("/api/v1/runs").json()["counts"]["queued"] == 2


def test_the_number_of_stored_evaluations_of_a_user(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(service.app.state._state, "quota", Quota(100, 3, 10**12))
    found = client.get("/api/v1/runs/R-0001").json()["evaluations"]
    assert found >= 3
    refused = problem(client.post("/api/v1/runs", json={"campaign": campaign(seed=5)}), 409)
    assert f"{found:,} stored evaluations" in str(refused["detail"])


def test_what_the_runs_of_a_user_store(service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is the size of what is there, and counts against the quota."""
    typed = yaml.safe_dump(campaign(name="Größe"), allow_unicode=True).encode()
    assert client.post("/api/v1/runs", content=typed, headers={"content-type": "application/yaml"}).status_code == 201
    with service.engine.connect() as reader:
        sizes = dict(reader.execute(sa.select(Run.id, Run.size)).all())
        assert sizes == {run: stored_size(reader, run) for run in sizes}
    assert min(sizes[1], sizes[max(sizes)]) > 0, "evaluations, and a text"
    counted = sum(sizes.values())
    monkeypatch.setitem(service.app.state._state, "quota", Quota(100, 10**9, counted))
    refused = problem(client.post("/api/v1/runs", json={"campaign": campaign(seed=5)}), 409)
    assert f"{counted:,} bytes " in str(refused["detail"])
    assert "CLEARANCE_MAX_BYTES_EACH" in str(refused["detail"])
