"""Recordings of flights: content of the file, entity tag, content security policy, and refusals."""

from __future__ import annotations

import base64
import re
import threading
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import msgspec
import numpy as np
import pytest
import viser
import zstandard

from backend.scenes.base import setting
from backend.scenes.base.declaration import axes_in, values
from backend.scenes.base.flight import Flight, from_live
from backend.scenes.drawing.drawn import dots_of
from backend.scenes.recordings import recording as recorder
from backend.scenes.recordings.recording import Cast, record
from campaigns.results.scene import Scene
from tests.given.declared_traces import SCENE, declared, trace
from tests.given.finished_runs import Work, encounter, finish, straight
from tests.given.listening_ports import listening
from tests.given.problem_documents import problem
from tests.given.service import Service, until
from tests.given.shipped_runs import shipped
from tests.given.submissions import submit


@pytest.fixture(autouse=True)
def frames(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two a second where nothing is said of their number, which is most of the time that a recording takes."""
    if "bare" not in request.fixturenames:
        monkeypatch.setattr(recorder, "RATE", 2.0)


@pytest.fixture(scope="module")
def client(guest: httpx.Client) -> httpx.Client:
    """That of the shared service: making a recording takes a second, and the service caches some."""
    return guest


@pytest.fixture(scope="module")
def run(still: Service, client: httpx.Client) -> str:
    """A finished run with a nominal flight and F1."""
    run = submit(client)
    finish(still)
    return run


Rename = Callable[[str], object]


@pytest.fixture
def rename(client: httpx.Client, run: str) -> Iterator[Rename]:
    """Gives the run another name for the time of a test."""
    name = client.get(f"/api/v1/runs/{run}").json()["name"]
    yield lambda other: client.patch(f"/api/v1/runs/{run}", json={"name": other})
    client.patch(f"/api/v1/runs/{run}", json={"name": name})


def played(page: str) -> dict[str, Any]:
    """What a page plays, as viser's own reader finds it: length [s], messages with their times."""
    found = re.search(r'__VISER_EMBED_DATA__="([^"]+)"', page)
    assert found is not None
    data = base64.b64decode(found[1])
    inner = zstandard.ZstdDecompressor().decompress(data[8:], max_output_size=int.from_bytes(data[:8], "little"))
    size = int.from_bytes(inner[:8], "little")
    decoded: dict[str, Any] = msgspec.msgpack.decode(inner[8 : 8 + size])
    return decoded


def of(recording: dict[str, Any], kind: str, name: str) -> list[tuple[float, dict[str, Any]]]:
    """The messages of a kind about a node, with their times [s]."""
    return [(time, m) for time, m in recording["messages"] if m["type"] == kind and m.get("name") == name]


@pytest.mark.nightly
def test_the_file_plays_the_stored_flights_in_their_own_time(bare: Service) -> None:
    bare.publish()
    with bare.signed_in() as client:
        run = submit(client)
        finish(bare)
        answer = client.get(f"/api/v1/runs/{run}/exports/flight-F1.html")
    assert answer.headers["content-type"].startswith("text/html")
    named = 'attachment; filename="R-0001-unicycle-past-a-pillar-flight-F1.html"'
    assert answer.headers["content-disposition"] == named
    recording = played(answer.text)
    assert recording["viserVersion"] == viser.__version__
    assert recording["durationSeconds"] == pytest.approx(15.0)
    times = [time for time, _ in recording["messages"]]
    assert times == sorted(times)
    for flight, passing in (("nominal", 0.9), ("worst", 0.8)):
        ways = of(recording, "SetPositionMessage", f"/flights/{flight}/vehicle")
        assert len(ways) == 301, "20 a second, and where it starts"
        for time, message in ways:
            assert message["position"][:2] == pytest.approx((6 * time / 15, 4 + passing), abs=1e-9)
    told = {m["props"]["text"] for _, m in recording["messages"] if m["type"] == "LabelMessage"}
    assert {"Nominal 0.9000 m", "F1 0.8000 m", "d_min > 0.5 m", "start", "goal"} <= told
    now = of(recording, "SceneNodeUpdateMessage", "/flights/worst/now")
    assert {m["updates"]["text"] for time, m in now if abs(time - 10.0) < 1e-6} == {"F1: 0.8000 m now"}


@pytest.mark.nightly
def test_intruders_and_heights_are_played(bare: Service) -> None:
    with bare.signed_in() as client:
        run = shipped(bare, client, "uav_aca")
        work = Work(bare)
        work.nominal(encounter("nominal", "ned", straight(500, 60, -30, -20, 0, -1)))
        recording = played(client.get(f"/api/v1/runs/{run}/exports/flight-nominal.html").text)
    assert not of(recording, "FrameMessage", "/flights/worst/vehicle")
    intruder = of(recording, "SetPositionMessage", "/obstacles/0")
    own = of(recording, "SetPositionMessage", "/flights/nominal/vehicle")
    assert len(intruder) >= len(own) > 400
    for time, message in own:
        assert message["position"] == pytest.approx((5, 20 * time, 2 * time), abs=1e-9)
    for time, message in intruder:
        assert message["position"] == pytest.approx((60, 500 - 20 * time, 30 + time), abs=1e-9)


def test_a_case_of_a_simulator_plays_what_its_trace_declares(bare: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is claimed that the trace does not have: no separation over time, no closest approach."""
    monkeypatch.setattr(recorder, "RATE", 2.0)
    with bare.signed_in() as client:
        run = declared(bare, client, lambda name: trace(name, speed=1.0 if name == "nominal" else 0.5))
        (offered,) = [f for f in client.get(f"/api/v1/runs/{run}/exports").json() if "/flight-" in f["href"]]
        assert (offered["title"], offered["unavailable"]) == ("Case F1 in 3D, HTML", None)
        page = client.get(offered["href"], timeout=60).text
        assert client.get(f"/view/{run}/F1/recorded/", timeout=60).text == page
    recording = played(page)
    assert recording["durationSeconds"] == pytest.approx(20.0)
    for time, message in of(recording, "SetPositionMessage", "/flights/worst/vehicle"):
        assert message["position"] == pytest.approx((0.5 * time, 0, 100 - 5 * time))
    for time, message in of(recording, "SetPositionMessage", "/obstacles/1"):
        assert message["position"] == pytest.approx((-time, 5, 20))
    now = of(recording, "SceneNodeUpdateMessage", "/flights/worst/now")
    assert {m["updates"]["text"] for _, m in now if "text" in m["updates"]} <= {"F1"}
    told = {m["props"]["text"] for _, m in recording["messages"] if m["type"] == "LabelMessage"}
    assert {"mast", "bird"} <= told
    assert not any("now" in text or "d_min" in text for text in told)
    card = page[page.index('<details id="caption"') : page.index("</details>")]
    for words in (
        "The play bar shows the time of the trace in seconds",
        "Positions come from the trace of the simulator, obstacles from its declaration.",
        "The trace of F1 is one more call with its own value; the run stored 0.300 m.",
        "2.000 m",
        "d_min &gt; 1 m",
    ):
        assert words in card


def over(first: float, last: float) -> Flight:
    """A declared case from one time to another [s]."""
    flown = trace("nominal")
    data = {column.name: flown.data[:, k] for k, column in enumerate(flown.columns)}
    data["time"] = np.linspace(first, last, 401)
    columns = [column.model_dump() for column in flown.columns]
    found = from_live({"columns": columns, "data": data, "meta": flown.meta.model_dump(), "identity": {}})
    assert found is not None
    return found


@pytest.mark.parametrize(("times", "dots"), [((0.0, 20.0), 11), ((3.0, 3.1), 1), ((-1.0, 5.0), 3), ((-9e9, -8e9), 11)])
def test_a_path_has_some_dots_whatever_its_time(times: tuple[float, float], dots: int) -> None:
    found = dots_of(over(*times), 20.0)
    assert len(found) == dots
    assert times[0] <= found.min() <= found.max() <= times[1] + 1e-9


@pytest.mark.parametrize("last", [0.0, -1e9])
def test_a_trace_that_ends_before_time_zero_is_a_still_picture(last: float) -> None:
    """The time of a simulator's trace may be any that does not go back."""
    scene = Scene.model_validate(SCENE)
    moving = [False] * len(scene.obstacles) + [True] * len(scene.bodies)
    drawn = setting.Setting(
        run="R-0001", title="Drop", digest="", document={}, planar=scene.planar, axes=axes_in(scene), vehicle="",
        start=np.zeros(3), goal=None, course=None, values=values(scene), moving=moving, threshold=1.0, to_surface=False,
        quantity="d_min", unit="m", horizon=1.0, uncertain=[], methods=[], scene=scene,
    )  # fmt: skip
    made = record(drawn, Cast("nominal", over(last - 20.0, last), None), dark=False)
    assert played(made.html)["durationSeconds"] == 0.0


def test_the_caption_describes_what_is_shown(client: httpx.Client, run: str, rename: Rename) -> None:
    rename("<script>alert(1)</script> & co")
    page = client.get(f"/api/v1/runs/{run}/exports/flight-F1.html").text
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; co" in page
    card = page[page.index('<details id="caption"') : page.index("</details>")]
    detail = client.get(f"/api/v1/runs/{run}").json()
    exported = client.get(f"/api/v1/runs/{run}/exports/run.json").json()
    for words in (
        "R-0001 · F1",
        "0.8000 m",
        "0.9000 m",
        "d_min &gt; 0.5 m",
        detail["campaign_digest"],
        exported["results_digest"],
        f"viser {viser.__version__}",
        "violated",
        "The play bar shows flight time in seconds; dots every 2 s. The length of an arrow is",
    ):
        assert words in card


@pytest.mark.nightly
def test_a_file_that_is_there_already_is_not_sent_again(client: httpx.Client, run: str, rename: Rename) -> None:
    place = f"/api/v1/runs/{run}/exports/flight-F1.html"
    first = client.get(place)
    tag = first.headers["etag"]
    again = client.get(place, headers={"If-None-Match": tag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    assert client.get(f"{place}?theme=dark").headers["etag"] != tag
    rename("Another name")
    assert client.get(place, headers={"If-None-Match": tag}).status_code == 200


def test_the_page_plays_the_same_and_makes_no_requests(client: httpx.Client, run: str) -> None:
    page = client.get(f"/view/{run}/F1/recorded/")
    assert page.text == client.get(f"/api/v1/runs/{run}/exports/flight-F1.html").text
    policy = page.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "connect-src data: blob:;" in policy
    assert "frame-ancestors 'self'" in policy
    assert page.headers["content-disposition"].startswith("inline")
    assert client.get(f"/view/{run}/F1/recorded").headers["location"] == f"/view/{run}/F1/recorded/"
    assert "darkMode:true" in client.get(f"/view/{run}/F1/recorded/dark/").text
    assert f"{policy.partition('; frame')[0]}" in page.text, "so does the file, wherever it is opened"


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/view/R-0001/F2/recorded/", 404),
        ("/view/R-0009/F1/recorded/", 404),
        ("/view/R-0001/F1/recorded/t/3", 404),
        ("/view/R-0001/F1/recorded/?playbackPath=/view/R-0001/F1/recorded/", 400),
        ("/view/R-0001/F1/recorded/?websocket=ws://evil.example", 400),
        ("/api/v1/runs/R-0001/exports/flight-F2.html", 404),
        ("/api/v1/runs/R-0001/exports/flight-F1.html?theme=pink", 422),
    ],
)
def test_other_addresses_are_refused(client: httpx.Client, run: str, path: str, status: int) -> None:
    problem(client.get(path), status)


def test_it_is_behind_the_login(still: Service, run: str) -> None:
    with still.visitor() as stranger:
        assert stranger.get(f"/view/{run}/F1/recorded/").status_code == 401
        assert stranger.get(f"/api/v1/runs/{run}/exports/flight-F1.html").status_code == 401


def test_making_one_leaves_nothing_behind(still: Service, client: httpx.Client, run: str, rename: Rename) -> None:
    rename("Not recorded before")
    ports, known = listening(), set(threading.enumerate())
    for theme in ("light", "dark"):
        assert client.get(f"/api/v1/runs/{run}/exports/flight-F1.html?theme={theme}").status_code == 200
    until(lambda: listening() == ports)
    until(lambda: not {t for t in threading.enumerate() if t not in known and "AnyIO" not in t.name})
    assert still.app.state.viewers.open == 0
