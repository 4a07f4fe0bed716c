"""A page controls the 3D view that it opened, and no other."""

from __future__ import annotations

import re
import threading
import time
from typing import Any

import httpx
import numpy as np
import pytest
import viser

from backend.scenes.drawing import following
from backend.scenes.live.live import Live
from backend.scenes.viewer.replay import Replay
from backend.scenes.viewer.viewer import FAILED
from tests.given.at_night import nightly_but
from tests.given.finished_runs import Work, finish, flight
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, Panel, frames_until, steer, viewing

OTHER = "ffffffff-ffff-4fff-bfff-ffffffffffff"


def finished(service: Service, client: httpx.Client) -> str:
    """A finished run with two findings, of which the second passes further off."""
    run = submit(client)
    work = Work(service)
    work.nominal()
    work.found(("F1",))
    work.found(("F2",), flight("F2", passing=0.85))
    work.conclude()
    return run


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """That of a separate service."""
    return finished(service, client)


@pytest.fixture(scope="module")
def flown(still: Service, guest: httpx.Client) -> str:
    """That of the shared service."""
    return finished(still, guest)


def address(run: str, key: str = KEY) -> str:
    return f"/api/v1/runs/{run}/views/{key}"


def statement(state: dict[str, Any]) -> dict[str, Any]:
    """The predictable part of a view's state."""
    assert state["revision"] > 0
    return {name: state[name] for name in ("opened", "flight", "time", "camera", "playing", "theme")}


def test_a_page_controls_its_view_and_receives_its_state(service: Service, client: httpx.Client, run: str) -> None:
    with viewing(service, client, f"/view/{run}/t/2/key/{KEY}/") as connection:
        shown = {"flight": "F1", "time": 2.0, "camera": "overview", "playing": False, "theme": "light"}
        answer = client.get(address(run), params={"wait": 10}).json()
        shown["opened"] = answer["opened"]
        assert statement(answer) == shown
        assert time.time() - 30 < answer["opened"] <= time.time()
        Panel(connection, last="Search")
        assert statement(steer(client, run, flight="F2", time=7.25)) == shown | {"flight": "F2", "time": 7.25}
        received = frames_until(connection, b"F2 0.8500 m")
        assert b"/flights/worst/path" in received
        assert b"/flights/nominal/path" not in received, "only what is new is drawn"
        steer(client, run, theme="dark", camera="top")
        frames_until(connection, b"ThemeConfigurationMessage", b"/flights/nominal/path", b"/obstacles/0/ring")
        assert steer(client, run, step=-0.25)["time"] == 7.0
        assert steer(client, run, time=6.5, passing=True)["time"] == 6.5
        assert steer(client, run, playing=True)["playing"]
        assert steer(client, run, time=1.0, passing=True)["playing"], "it plays on"
        assert not steer(client, run, time=7.0)["playing"]
        assert steer(client, run, time=1e9)["time"] == 15.0
        assert steer(client, run, step=-1e9)["time"] == 0.0
        assert steer(client, run, playing=True)["playing"]
        until(lambda: client.get(address(run)).json()["time"] > 0.05)
        assert statement(steer(client, run, closest=True)) == {
            "opened": answer["opened"],
            "flight": "F2",
            "time": pytest.approx(10.0, abs=0.01),
            "camera": "top",
            "playing": False,
            "theme": "dark",
        }
        assert steer(client, run, flight="F1")["time"] == pytest.approx(10.0, abs=0.01)
        assert steer(client, run, flight="nominal")["flight"] == "nominal"


def test_a_request_may_wait_for_the_view_to_open(service: Service, client: httpx.Client, run: str) -> None:
    answers: list[dict[str, Any]] = []
    asking = threading.Thread(target=lambda: answers.append(steer(client, run, flight="F2")), daemon=True)
    asking.start()
    with viewing(service, client, f"/view/{run}/key/{KEY}") as connection:
        frames_until(connection, b"F2 0.8500 m")
        asking.join(10)
    assert [answer["flight"] for answer in answers] == ["F2"]


def test_the_camera_follows_until_the_visitor_moves_it(service: Service, client: httpx.Client, run: str) -> None:
    with viewing(service, client, f"/view/{run}/t/2/key/{KEY}") as connection:
        panel = Panel(connection, last="Search")
        panel.told()
        steer(client, run, camera="chase")
        before = panel.told()
        panel.look(*before)
        steer(client, run, time=7.0)
        eye, target = panel.told()
        assert eye - before[0] == pytest.approx(np.array([0.4 * 5, 0, 0]), abs=1e-6), "along with the vehicle"
        assert target - before[1] == pytest.approx(np.array([0.4 * 5, 0, 0]), abs=1e-6)
        assert client.get(address(run)).json()["camera"] == "chase"
        panel.look(eye + np.array([0.0, 0.5, 0.0]), target)
        until(lambda: client.get(address(run)).json()["camera"] is None)
        steer(client, run, time=9.0)
        with pytest.raises(TimeoutError):
            panel.told(seconds=0.3)
        steer(client, run, camera="intruder")
        eye, target = panel.told()
        vehicle = np.array([0.4 * 9, 4.8, target[2]])
        assert target == pytest.approx(vehicle, abs=1e-3)
        assert np.linalg.norm(eye[:2] - (4, 4)) < np.linalg.norm(eye[:2] - vehicle[:2]), "the obstacle is between"


def test_a_browser_is_sent_on_once_it_has_come(
    service: Service, client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(following, "PATIENCE", 60.0)
    with viewing(service, client, f"/view/{run}/t/2/cam/chase/key/{KEY}") as connection:
        panel = Panel(connection, last="Search")
        first = sent = panel.told()
        steer(client, run, time=4.0)
        for moment in (5.0, 6.0, 7.0):
            steer(client, run, time=moment)
        with pytest.raises(TimeoutError):
            panel.told(seconds=0.3)
        panel.look(*sent)
        eye, _ = panel.told()
        assert eye - first[0] == pytest.approx(np.array([0.4 * 5, 0, 0]), abs=1e-6), "to the newest time at once"


def test_where_a_browser_was_only_sent_it_has_not_come(service: Service, client: httpx.Client, run: str) -> None:
    """viser's handle holds what was sent last, also where that happens before a report of the browser is handled."""
    with viewing(service, client, f"/view/{run}/t/2/cam/top/key/{KEY}") as connection:
        panel = Panel(connection, last="Search")
        sent = panel.told()
        (shown,) = service.app.state.viewers.steered.values()
        (browser,) = shown._server.get_clients().values()

        async def send_again(camera: viser.CameraHandle) -> None:
            camera.position, camera.look_at = sent

        browser.camera._state.camera_cb.insert(0, send_again)
        for start in (np.full(3, 3.0), np.full(3, 3.5)):
            panel.look(start, np.zeros(3))
        panel.look(*sent)
        until(lambda: shown._following._heard)
        assert client.get(address(run)).json()["camera"] == "top"
        panel.look(np.full(3, 4.0), np.zeros(3))
        until(lambda: client.get(address(run)).json()["camera"] is None)


def test_a_browser_may_leave_while_its_camera_is_moved(
    service: Service, client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with viewing(service, client, f"/view/{run}/t/2/key/{KEY}") as connection:
        Panel(connection, last="Search").told()
        (shown,) = service.app.state.viewers.steered.values()
        server, camera = shown._server, shown._following
        clients = server.get_clients()
    until(lambda: all(c._websock_connection.get_message_buffer().done for c in clients.values()))
    monkeypatch.setattr(server, "get_clients", lambda: clients)  # as requested just before
    camera.set(None, (np.zeros(3), np.ones(3)))
    camera.work(time.monotonic())
    assert len(clients) == 1


@pytest.mark.by_day(1)
@pytest.mark.parametrize("camera", ["chase", "intruder", "encounter"])
def test_a_camera_of_the_address_is_there_from_the_first(
    service: Service, client: httpx.Client, run: str, camera: str
) -> None:
    with viewing(service, client, f"/view/{run}/t/2/cam/{camera}/key/{KEY}") as connection:
        panel = Panel(connection, last="Search")
        eye, target = panel.told()
        panel.look(eye, target)
        assert client.get(address(run)).json()["camera"] == camera


def test_a_key_is_good_for_its_run_and_its_visitor_alone(service: Service, client: httpx.Client, run: str) -> None:
    other = submit(client)
    token = service.token("ci")
    with (
        viewing(service, client, f"/view/{run}/key/{KEY}"),
        viewing(service, client, f"/view/{other}/key/{OTHER}"),
        service.visitor(Authorization=f"Bearer {token}") as stranger,
    ):
        steer(client, run, time=1.0)
        steer(client, other, OTHER, time=1.0)
        for asking, path in (
            (client, address(run, OTHER)),
            (client, address(other, KEY)),
            (stranger, address(run)),
        ):
            detail = problem(asking.patch(path, json={"time": 2.0}), 404)["detail"]
            assert "no 3D view of" in detail
            problem(asking.get(path), 404)
            advised = re.search(r"open (/view/\S+/) first", detail)
            assert advised, detail
            assert asking.get(advised[1]).status_code == 200
        for absent in (client.patch(address("R-0099"), json={"time": 2.0}), client.get(address("R-0099"))):
            assert "/view/" not in problem(absent, 404)["detail"]
        assert steer(client, run)["time"] == 1.0
    until(lambda: service.app.state.viewers.open == 0)
    problem(client.get(address(run)), 404)


REFUSED: list[dict[str, Any]] = [
    {"flight": "F9"},
    {"flight": "F0"},
    {"time": -1.0},
    {"time": "nan"},
    {"camera": "behind"},
    {"closest": True, "time": 1.0},
    {"theme": "purple"},
    {"speed": 3.0},
    {"gear": 2.0},
    {"camera": "top", "eye": {"position": [0, 0, 9], "target": [0, 0, 0]}},
    {"eye": {"position": [0, 0, "inf"], "target": [0, 0, 0]}},
    {"layers": {"shadows": True}},
    {"layers": {"axes": ["vehicle.m", "vehicle.mass", "none"]}},
    {"what_if": {"vehicle.mass": 5.0}},
    {"what_if": {"vehicle.m": 50.0}},
    {"what_if_seed": 3},
    {"what_if": {"vehicle.m": 5.0}, "what_if_seed": -1},
]
OF_A_KIND = ({"flight": "F0"}, {"time": "nan"}, {"camera": "behind"}, {"gear": 2.0}, {"layers": {"shadows": True}},
             {"what_if_seed": 3}, {"what_if": {"vehicle.mass": 5.0}})  # fmt: skip
"""As others are refused by day: another flight, time, word, number, layer, seed or parameter."""


@pytest.mark.by_day(3)
@pytest.mark.parametrize("change", nightly_but([one for one in REFUSED if one not in OF_A_KIND], REFUSED), ids=str)
def test_what_cannot_be_shown_is_refused(
    still: Service, guest: httpx.Client, flown: str, change: dict[str, Any]
) -> None:
    with viewing(still, guest, f"/view/{flown}/key/{KEY}"):
        before = steer(guest, flown)
        assert problem(guest.patch(address(flown), json=change), 422)["detail"]
        assert guest.get(address(flown)).json() == before
    problem(guest.patch(address(flown, "x"), json={}), 422)


def test_a_view_whose_thread_fails_says_so_and_can_be_opened_again(
    service: Service,
    client: httpx.Client,
    run: str,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    error = RuntimeError("nothing can be drawn here")

    def fails(self: Replay, seconds: float) -> None:
        raise error

    path = f"/view/{run}/t/2/key/{KEY}"
    with viewing(service, client, path) as connection:
        Panel(connection, last="Search")
        known = steer(client, run)
        monkeypatch.setattr(Replay, "advance", fails)
        steer(client, run, playing=True)
        known["revision"] += 1
        statement = problem(client.get(address(run), params={"since": known["revision"], "wait": 20}), 410)
        assert statement["detail"] == FAILED
        frames_until(connection, FAILED.encode())
        for refused in (client.get(address(run)), client.patch(address(run), json={"time": 1.0})):
            assert problem(refused, 410)["detail"] == FAILED
        logged = [r for r in caplog.records if "ended with an error" in r.message]
        assert len(logged) == 1
        assert run in logged[0].message
        assert logged[0].exc_info is not None
        assert logged[0].exc_info[1] is error
        monkeypatch.undo()
        with viewing(service, client, path):  # before the failed one is closed, as a page does
            assert steer(client, run, time=3.0)["time"] == 3.0
            assert steer(client, run, playing=True)["playing"]
            until(lambda: client.get(address(run)).json()["time"] > 3.05)
    until(lambda: service.app.state.viewers.open == 0)


def test_of_two_views_with_one_key_the_newer_is_used(service: Service, client: httpx.Client, run: str) -> None:
    path = f"/view/{run}/key/{KEY}"
    with viewing(service, client, path):
        steer(client, run, time=1.0)
        with viewing(service, client, path):
            until(lambda: client.get(address(run)).json()["time"] > 5, 5)
            steer(client, run, time=2.0)
        until(lambda: service.app.state.viewers.open == 1)
        problem(client.get(address(run)), 404)
    with viewing(service, client, path):
        steer(client, run, time=3.0)
        with viewing(service, client, path) as newer:
            frames_until(newer, b"/flights/nominal/path")
            until(lambda: service.app.state.viewers.open == 2)
    until(lambda: service.app.state.viewers.open == 0)
    assert service.app.state.viewers.steered == {}


def test_a_run_without_findings_takes_any_label(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    other = submit(client)
    with viewing(service, client, f"/view/{other}/key/{KEY}"):
        assert steer(client, other, flight="F7")["flight"] == "F7"
    assert run != other


def test_a_change_of_what_is_shown_is_published_at_once(
    service: Service, client: httpx.Client, run: str, process: Live
) -> None:
    service.app.state.live = process  # for the layers that simulate
    with viewing(service, client, f"/view/{run}/t/2/key/{KEY}") as connection:
        panel = Panel(connection, last="Search")
        panel.told()
        known = steer(client, run)

        def news(wait: float = 20.0) -> dict[str, Any]:
            answer = client.get(address(run), params={"since": known["revision"], "wait": wait})
            assert answer.status_code == 200, answer.text
            return dict(answer.json())

        assert news(wait=0.1) == known, "nothing has changed"
        for name, value in (("flight", "F2"), ("time", 3.5), ("camera", "top"), ("speed", 5.0), ("playing", True)):
            steer(client, run, **{name: value})
            known = news()
            assert known[name] == value
        steer(client, run, playing=False)
        for name in ("nominal", "finding", "what_if", "velocity", "relative", "sampled", "field"):
            known = steer(client, run)
            before = known["layers"][name]
            steer(client, run, layers={name: not before})
            known = news()
            assert known["layers"] == steer(client, run)["layers"]
            assert known["layers"][name] is not before
        steer(client, run, camera="top")
        known = steer(client, run)
        # The visitor's own doing: the camera is moved.
        panel.look(*panel.told())
        panel.look((1.0, 2.0, 3.0), (1.0, 2.5, 0.0))
        known = news()
        until(lambda: client.get(address(run)).json()["eye"])
        assert client.get(address(run)).json()["eye"]["position"] == [1.0, 2.0, 3.0]
        assert client.get(address(run)).json()["camera"] is None
        known = steer(client, run)
        gone: list[httpx.Response] = []
        asking = threading.Thread(
            target=lambda: gone.append(client.get(address(run), params={"since": known["revision"], "wait": 20})),
            daemon=True,
        )
        asking.start()
    asking.join(10)
    problem(gone[0], 404)


def test_the_panel_has_nothing_that_the_page_offers(service: Service, client: httpx.Client, run: str) -> None:
    with viewing(service, client, f"/view/{run}/key/{KEY}/") as connection:
        panel = Panel(connection, last="Search")
        assert {label for label in panel._elements if not label.startswith("Values, ")} == set()


def test_a_reopened_view_can_be_restored_to_all_that_it_showed(
    service: Service, client: httpx.Client, run: str
) -> None:
    layers = {"nominal": False, "relative": True, "trail": "so_far"}
    wanted = {"flight": "F2", "time": 3.5, "camera": "side", "speed": 0.5, "theme": "dark", "layers": layers}
    path = f"/view/{run}/key/{KEY}"
    with viewing(service, client, path):
        before = steer(client, run, **wanted)
        assert before["layers"] | layers == before["layers"]
    until(lambda: service.app.state.viewers.open == 0)
    fixed = {"opened": 0.0, "revision": 0}
    again = {name: value for name, value in before.items() if name not in (*fixed, "horizon", "eye", "what_if")}
    with viewing(service, client, path):
        after = steer(client, run, **again)
        assert after | fixed == before | fixed
        assert after["revision"] > before["revision"], "news of one view are newer than those of the one before"
    until(lambda: service.app.state.viewers.open == 0)
    eye = {"position": [1.0, 2.0, 30.0], "target": [1.0, 2.5, 0.0]}
    with viewing(service, client, path) as connection:
        shown = steer(client, run, eye=eye, layers={"field": True})
        assert (shown["eye"], shown["camera"], shown["layers"]["field"]) == (eye, None, True)
        position, target = Panel(connection, last="Search").told()
        assert position.tolist() == eye["position"]
        assert target.tolist() == eye["target"]


def test_the_limit_of_views_is_reported_on_the_page(service: Service, client: httpx.Client, run: str) -> None:
    service.app.state.viewers.most = 0
    assert "0 3D views are open" in problem(client.patch(address(run), json={}), 503)["detail"]
