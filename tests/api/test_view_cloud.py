"""The parameter space in a viewer: shown instead of the flights, and a click that simulates a stored evaluation."""

from __future__ import annotations

import html
import re
from typing import Any

import httpx
import msgspec
import numpy as np
import pytest
from websockets.sync.client import ClientConnection

from backend.db.engine import read
from backend.scenes.base import setting
from backend.scenes.base.palette import DARK, LIGHT
from backend.scenes.control.relay import open_server
from backend.scenes.drawing.world import ROOTS, World
from campaigns import library, load_file
from campaigns.results.base import FAILED, OK
from campaigns.stored.records import Columns
from clearance.testing.problems import Problem
from tests.api.declaring import declared
from tests.api.finished import Work, encounter, finish, straight
from tests.api.lost import lose
from tests.api.server import Service
from tests.api.shipped import shipped
from tests.api.submitting import submit
from tests.api.viewing import KEY, Panel, frames, frames_until, steer, viewing

NOMINAL = np.array([[0.5, 0.5]])


@pytest.fixture(scope="module")
def cost() -> float:
    """What a search stores of the nominal case of case 1."""
    batch, _ = Problem(load_file(library()["unicycle_static"])).evaluate(NOMINAL)
    return float(batch.costs[0, 0])


def stored(service: Service, cost: float) -> None:
    """One evaluation, at the middle of every axis."""
    work = Work(service)
    work.store.begin(2)
    work.store.append(2, 0, Columns(NOMINAL, np.array([[cost]]), np.zeros(1, np.uint8), np.ones(1), {}))


def camera(connection: ClientConnection) -> tuple[Any, Any]:
    """Position and target of the camera as sent to the browser, once the points are drawn."""
    eye = target = None
    drawn = False
    for frame in frames(connection):
        drawn = drawn or b"/space/ok" in frame
        for message in msgspec.msgpack.decode(frame)["messages"]:
            if message["type"] == "SetCameraPositionMessage":
                eye = message["position"]
            if message["type"] == "SetCameraLookAtMessage":
                target = message["look_at"]
        if drawn and eye is not None and target is not None:
            break
    return np.array(eye), np.array(target)


def click(panel: Panel, eye: Any, direction: Any) -> None:
    panel._say(
        type="ScenePointerMessage",
        event_type="click",
        ray_origin=tuple(float(x) for x in eye),
        ray_direction=tuple(float(x) for x in direction),
        screen_pos=((0.5, 0.5),),
        modifier=None,
    )


def test_a_click_on_a_point_simulates_it_and_compares_it_with_the_stored_cost(simulating: Service, cost: float) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "unicycle_static")
        stored(simulating, cost)
        with viewing(simulating, client, f"/view/{run}/key/{KEY}/") as connection:
            panel = Panel(connection, last="Show its flight")
            steer(client, run, layers={"space": True})
            eye, middle = camera(connection)
            click(panel, eye, (0.0, 0.0, 1.0))
            frames_until(connection, b"There is no evaluation near that position.")
            click(panel, eye, middle - eye)
            received = frames_until(connection, b"Bit-identical.", b"/flights/what-if/path", seconds=120)
            assert b"search \xc2\xb7 direct, evaluation 0 (from 0)" in received
            assert repr(cost).encode() in received
            panel.set("Show its flight", True)
            frames_until(connection, b"SetSceneNodeVisibility", b"SetCamera")


def test_of_a_simulator_a_click_shows_what_is_stored_and_evaluates_nothing(bare: Service) -> None:
    with bare.signed_in() as client:
        costs, status = np.array([[0.3], [np.nan]]), np.array([OK, FAILED], np.uint8)
        searched = Columns(np.array([[0.25], [0.75]]), costs, status, np.ones(2), {1: "it hung"})
        run = declared(bare, client, searched=searched)
        with viewing(bare, client, f"/view/{run}/key/{KEY}/") as connection:
            panel = Panel(connection, last="Search")
            steer(client, run, layers={"space": True, "axes": ["simulator.wind", "value", "none"]})
            received = frames_until(connection, b"/space/ok", b"/space/failed", b"of those drawn")
            assert b"Click a point for its stored values." in received
            assert b"2 of 2 evaluations." in received
            (viewer,) = bare.app.state.viewers.steered.values()
            drawn = viewer._panel._cloud._drawn
            for row, words in ((0, b"Stored: d_min = 0.3 m, margin \xe2\x88\x920.700 m."), (1, b"Failed. it hung")):
                click(panel, drawn.points[row] - np.array([0.0, 0.01, 0.0]) * drawn.side, (0.0, 1.0, 0.0))
                said = frames_until(connection, words)
                assert f"evaluation {row} (from 0)".encode() in said
            assert steer(client, run)["layers"]["axes"] == ["simulator.wind", "value", "none"]
        assert bare.app.state.live._child is None
        assert bare.app.state.cases._child is None


def test_failures_are_shown_and_counted(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    with viewing(service, client, f"/view/{run}/key/{KEY}/") as connection:
        panel = Panel(connection, last="Show its flight")
        steer(client, run, layers={"space": True})
        received = frames_until(connection, b"/space/ok", b"/space/failed", b"evaluations", b"of those drawn")
        assert b"1000 of 1000 evaluations." in received
        assert b"failed: 100 of 100." in received
        assert b"no value" in received
        assert b"vehicle.m [kg]" in received
        panel.set("Axis z", "\u2013")
        again = frames_until(connection, b"/space/failed")
        assert b"no value" not in again


def test_excluded_and_failed_evaluations_have_their_own_marks_and_repeat_when_simulated_again(
    simulating: Service,
) -> None:
    with simulating.signed_in() as client:
        lost = lose(simulating, client)
        with viewing(simulating, client, f"/view/{lost.run}/key/{KEY}/") as connection:
            panel = Panel(connection, last="Show its flight")
            steer(client, lost.run, layers={"space": True})
            received = frames_until(connection, b"/space/ok", b"/space/failed", b"/space/excluded", b"of those drawn")
            assert b"21 of 21 evaluations." in received
            assert b"failed: 7 of 7." in received
            assert b"excluded: 4 of 4." in received
            (viewer,) = simulating.app.state.viewers.steered.values()
            drawn = viewer._panel._cloud._drawn
            for row, status in ((0, b"excluded"), (4, b"failed")):
                click(panel, drawn.points[row] - np.array([0.0, 0.01, 0.0]) * drawn.side, (0.0, 1.0, 0.0))
                said = frames_until(connection, b"simulated again", b"Identical: " + status, seconds=120)
                assert f"evaluation {row} (from 0)".encode() in said
                assert html.escape(lost.reasons[row]).encode() in said


def test_nothing_of_the_flights_is_left_out_when_they_are_hidden(bare: Service) -> None:
    """All nodes of a scene are below a node that is hidden with it, or have their own switch."""
    with bare.signed_in() as client:
        run = shipped(bare, client, "uav_aca")
        work = Work(bare)
        for flown in ("nominal", "F1"):
            trace = encounter(flown, "ned", straight(500, 60, -30, -20, 0, -1))
            work.nominal(trace) if flown == "nominal" else work.found(flown=trace)
        with viewing(bare, client, f"/view/{run}/F1/") as connection:
            received = frames_until(connection, b"/vectors/velocity", b"/north/label", b"Search")
            names = {name.decode() for name in re.findall(rb"\xa4name.{1,2}?/(\w+)", received, re.DOTALL)}
            assert {"flights", "ground", "north", "vectors"} <= names
            assert names <= {*ROOTS, "ground", "course", "space", "WorldAxes"}


def test_a_hidden_scene_stays_hidden_when_it_is_redrawn(service: Service, client: httpx.Client) -> None:
    submit(client)
    with read(service.engine) as reader:
        found = setting.load(reader, 1)
    server = open_server("nobody knows")
    try:
        world = World(server, found, LIGHT)
        for visible in (False, True):
            world.show(visible)
            world.paint(DARK)
            world.fit([])
            nodes = [*world._roots, *world._flat.values()]
            assert {node.visible for node in nodes} == {visible}
    finally:
        server.stop()
