"""The 3D view over the service's own port: its page, its socket, and that both are behind the login."""

from __future__ import annotations

import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
import websockets
from websockets.sync.client import connect

from backend.access import frames
from backend.access.frames import Voucher
from backend.db.access import Visitor
from backend.scenes.control import relay
from backend.scenes.endpoints import CSP
from campaigns.stored.records import StagePlan
from tests.given.finished_runs import Work, finish
from tests.given.listening_ports import listening
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.small_catalogue import published_by_workers
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, PROTOCOL, Panel, frames_until, steer, viewing


@pytest.fixture(scope="module")
def queued(guest: httpx.Client) -> str:
    """A run of the shared service."""
    return submit(guest)


def test_the_page_is_visers_with_a_policy_of_its_own(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    answer = client.get(f"/view/{run}/")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/html")
    policy = answer.headers["content-security-policy"]
    assert policy == CSP
    assert "frame-ancestors 'self'" in policy
    assert "unsafe-eval'" not in policy.replace("wasm-unsafe-eval'", "")
    assert client.get(f"/view/{run}").headers["location"] == f"/view/{run}/"
    assert client.get(f"/view/{run}/t/3.25/cam/encounter/dark").status_code == 200
    assert client.get(f"/view/{run}/F12/dark").status_code == 200
    plain = client.get(f"/view/{run}/", headers={"accept-encoding": "identity"})
    assert plain.content == answer.content


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/view/R-0099/", 404),
        ("/view/nothing/", 404),
        ("/view/R-0001/?websocket=ws://evil.example", 400),
        ("/view/R-0001/?playbackPath=//evil.example/x.viser", 400),
        ("/view/R-0001/t/nan", 404),
        ("/view/R-0001/t/", 404),
        ("/view/R-0001/purple", 404),
        ("/view/R-0001/F0", 404),
        ("/view/R-0001/cam/behind", 404),
        ("/view/R-0001/key/", 404),
        ("/view/R-0001/key/0", 404),
    ],
)
def test_other_addresses_are_refused(guest: httpx.Client, queued: str, path: str, status: int) -> None:
    problem(guest.get(path), status)


def test_the_scene_of_a_finished_run_arrives(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    with viewing(service, client, f"/view/{run}/t/3.2/dark") as connection:
        assert connection.subprotocol == PROTOCOL
        scene = (b"/flights/nominal/path", b"/flights/worst/path", b"/obstacles/0/ring", b"/goal/label")
        received = frames_until(connection, *scene, b"Search")
    assert b"Nominal 0.9000 m" in received
    assert b"Worst 0.8000 m" in received


def test_another_finding_or_the_nominal_flight_alone_can_be_looked_at(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    work.nominal()
    work.found(("F1", "F2"))
    work.conclude()
    with viewing(service, client, f"/view/{run}/F2/") as connection:
        received = frames_until(connection, b"/flights/worst/path", b"F2 0.8000 m")
        assert b"Worst 0.8000 m" not in received
    with viewing(service, client, f"/view/{run}/nominal/") as connection:
        received = frames_until(connection, b"/flights/nominal/path", b"Search", b"/goal/label")
        assert b"/flights/worst/path" not in received
        assert b"Show Worst" not in received


def test_what_is_found_while_watching_appears(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    with viewing(service, client, f"/view/{run}/") as connection:
        before = frames_until(connection, b"/obstacles/0/ring", b"Search")
        assert b"/flights/nominal/path" not in before
        work.nominal()
        frames_until(connection, b"/flights/nominal/path")
        work.search(0, 100)
        work.found()
        frames_until(connection, b"/flights/worst/path", b"Worst 0.8000 m")


def test_a_view_simulates_given_parameters(simulating: Service) -> None:
    """With the published catalogue, and the real simulation process."""
    simulating.publish(published_by_workers())
    with simulating.signed_in() as client:
        shipped = client.get("/api/v1/campaigns/unicycle_static").json()
        run = client.post("/api/v1/runs", json={"campaign": shipped["document"]}).json()["id"]
        plan = [StagePlan("nominal", None, 1), StagePlan("search", "monte_carlo", 100)]
        Work(simulating, plan).search(0, 100, stage=1)
        with viewing(simulating, client, f"/view/{run}/key/{KEY}/") as connection:
            steer(client, run, what_if={"vehicle.J": 0.06})
            frames_until(connection, b"What-if 0.9429 m", seconds=120)
            until(lambda: steer(client, run)["what_if"] == {"vehicle.m": 5.0, "vehicle.J": 0.06})
            steer(client, run, what_if={"vehicle.m": 6.0, "vehicle.J": 0.06})
            frames_until(connection, b"What-if 0.9417 m")
            steer(client, run, what_if={})
            frames_until(connection, b"What-if 0.9436 m")
            steer(client, run, layers={"sampled": True})
            frames_until(connection, b"/flights/sampled/5", b"the first 36 flights of the sample of Monte Carlo")


def test_the_flight_can_be_played_and_viewed_from_each_camera(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    with viewing(service, client, f"/view/{run}/t/1.0/key/{KEY}") as connection:
        Panel(connection, last="Search")

        def shown() -> dict[str, Any]:
            return dict(client.get(f"/api/v1/runs/{run}/views/{KEY}").json())

        steer(client, run, closest=True)
        assert shown()["time"] == pytest.approx(10.0, abs=0.01)
        steer(client, run, playing=True)
        until(lambda: shown()["time"] > 10.1)
        first = frames_until(connection, b"/flights/worst/vehicle")
        assert b"SetPosition" in first
        frames_until(connection, b"/flights/worst/vehicle")
        steer(client, run, playing=False)
        assert not shown()["playing"]
        steer(client, run, layers={"nominal": False})
        frames_until(connection, b"SetSceneNodeVisibility", b"/flights/nominal")
        steer(client, run, layers={"relative": True})
        frames_until(connection, b"/vectors/relative", b"v rel 0.400 m/s")
        steer(client, run, layers={"trail": "so_far"})
        frames_until(connection, b"/flights/worst/flown/last")
        steer(client, run, camera="top")
        frames_until(connection, b"SetCamera")


@pytest.mark.parametrize(
    "changes",
    [
        {"Cookie": None},
        {"Cookie": "clearance_8000=wrong"},
        {"Origin": "http://evil.example"},
        {"Origin": None},
        {"Origin": "null"},
    ],
    ids=str,
)
def test_a_socket_without_cookie_or_from_elsewhere_is_refused(
    still: Service, guest: httpx.Client, queued: str, changes: dict[str, str | None]
) -> None:
    with pytest.raises(websockets.InvalidStatus) as refused, viewing(still, guest, f"/view/{queued}/", **changes):
        pass
    assert refused.value.response.status_code == 403
    assert still.app.state.viewers.open == 0


async def _always() -> bool:
    return True


FRAMED: dict[str, str | None] = {"Cookie": None, "Origin": "null"}
"""How a sandboxed frame opens its socket."""


def test_a_frame_without_a_session_is_let_in_while_its_page_waits(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relay, "CHECK_PERIOD", 0.05)
    run = submit(client)
    finish(service)
    path = f"/view/{run}/F1/light/key/{KEY}/"
    with ThreadPoolExecutor(1) as page:
        asking = page.submit(steer, client, run, time=2.0)
        with viewing(service, client, path, **FRAMED) as connection:  # whoever comes first waits for the other
            frames_until(connection, b"/flights/nominal/path")
            assert asking.result()["time"] == 2.0
            assert steer(client, run)["time"] == 2.0
            # A second one with the same key, for which no page waits any more, and a session that ends.
            monkeypatch.setattr(frames, "PATIENCE", 0.0)
            with pytest.raises(websockets.InvalidStatus), viewing(service, client, path, **FRAMED):
                pass
            assert client.delete("/api/v1/session").status_code == 204
            with pytest.raises(websockets.ConnectionClosed) as closed:
                frames_until(connection, b"never")
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1008
    until(lambda: service.app.state.viewers.open == 0)
    assert service.app.state.frames._vouchers == {}


@pytest.mark.parametrize(
    ("path", "changes"),
    [
        (f"/view/RUN/key/{KEY[:-1]}0/", {}),
        (f"/view/RUN/key/{KEY}/key/{KEY[:-1]}0/", {}),
        (f"/view/R-0099/key/{KEY}/", {}),
        ("/view/RUN/", {}),
        (f"/view/RUN/key/{KEY}/", {"Origin": "http://evil.example"}),
        (f"/view/RUN/key/{KEY}/", {"Origin": None}),
        (f"/api/v1/runs/RUN/views/{KEY}", {}),
    ],
    ids=str,
)
def test_a_frame_is_let_in_by_the_key_of_its_page_alone(
    still: Service,
    guest: httpx.Client,
    queued: str,
    path: str,
    changes: dict[str, str | None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(frames, "PATIENCE", 0.0)
    expected = still.app.state.frames.expected
    with expected(queued, KEY, Voucher(Visitor("local", "link", role="admin"), _always)):
        with (
            pytest.raises(websockets.InvalidStatus) as refused,
            viewing(still, guest, path.replace("RUN", queued), **FRAMED | changes),
        ):
            pass
        assert refused.value.response.status_code == 403
        with still.visitor(origin="null") as frame:
            assert frame.get(f"/api/v1/runs/{queued}/views/{KEY}").status_code == 401
            assert frame.patch(f"/api/v1/runs/{queued}/views/{KEY}", json={}).status_code == 401
        # Not even with a cookie, which no browser sends from there.
        sent = {"origin": "null"}
        assert guest.patch(f"/api/v1/runs/{queued}/views/{KEY}", json={}, headers=sent).status_code == 403


@pytest.mark.parametrize("path", ["/view/R-0001/?websocket=x", "/view/R-0099/", "/view/x/", "/view/R-0001/purple"])
def test_a_socket_to_nowhere_is_refused(still: Service, guest: httpx.Client, queued: str, path: str) -> None:
    with pytest.raises(websockets.InvalidStatus), viewing(still, guest, path):
        pass


def test_there_is_a_most_of_viewers_and_one_gone_makes_room(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    service.app.state.viewers.most = 1
    with viewing(service, client, f"/view/{run}/"):
        with pytest.raises(websockets.InvalidStatus), viewing(service, client, f"/view/{run}/"):
            pass
        assert service.app.state.viewers.open == 1
    until(lambda: service.app.state.viewers.open == 0)
    with viewing(service, client, f"/view/{run}/"):
        pass


@pytest.mark.nightly
def test_nothing_of_a_viewer_remains_after_its_browser_has_gone(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)

    def open_and_close() -> None:
        with viewing(service, client, f"/view/{run}/cam/chase/key/{KEY}") as connection:
            frames_until(connection, b"/flights/nominal/path")
        until(lambda: service.app.state.viewers.open == 0)
        assert service.app.state.viewers.steered == {}

    open_and_close()
    known = set(threading.enumerate())
    for _ in range(3):
        open_and_close()
    until(lambda: not {t for t in threading.enumerate() if t not in known and "AnyIO" not in t.name})


def test_visers_own_port_refuses_other_clients(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    before = listening()
    with viewing(service, client, f"/view/{run}/") as connection:
        frames_until(connection, b"/flights/nominal/path")
        (port,) = listening() - before
        with connect(
            f"ws://127.0.0.1:{port}/", subprotocols=[websockets.Subprotocol(PROTOCOL)], compression=None, proxy=None
        ) as stranger:
            with pytest.raises(websockets.ConnectionClosed) as closed:
                stranger.recv(timeout=5)
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1008


def framed_and_refused(service: Service, client: httpx.Client, path: str) -> int:
    """The status with which a frame's socket is refused."""
    with pytest.raises(websockets.InvalidStatus) as refused, viewing(service, client, path, **FRAMED):
        pass
    return refused.value.response.status_code


def test_the_service_stops_at_once_with_streams_and_viewers_open(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = submit(client)
    finish(service)
    with (
        viewing(service, client, f"/view/{run}/") as connection,
        socket.create_connection(("127.0.0.1", service.port)) as raw,
    ):
        frames_until(connection, b"/flights/nominal/path")
        monkeypatch.setattr(frames, "PATIENCE", 1e9)
        waiting = ThreadPoolExecutor(1).submit(framed_and_refused, service, client, f"/view/{run}/key/{KEY}/")
        until(lambda: service.app.state.frames.waiting == 1)
        cookie = f"{service.settings.cookie}={client.cookies[service.settings.cookie]}"
        raw.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nCookie: {cookie}\r\n\r\n".encode())
        until(lambda: service.app.state.hub.listeners == 1)
        service.stop()  # within its patience, although nobody closes them
    assert waiting.result(10) >= 400
