"""The 3D view draws every flight at the positions of its trace: intruders that move, aircraft with z down."""

from __future__ import annotations

from functools import partial

import msgspec
import numpy as np
import pytest

from tests.given.finished_runs import Work, encounter, straight, turned
from tests.given.service import Service
from tests.given.shipped_runs import shipped
from tests.given.viewer_clients import KEY, Panel, frames, frames_until, steer, viewing


def test_an_intruder_moves_with_the_time_on_its_dashed_track(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "pioneer_moving")
        work = Work(simulating)
        work.nominal(encounter("nominal", "enu", straight(300, -40, 0, 0, 5, 0)))
        work.found(flown=encounter("F1", "enu", straight(300, -40, 0, 0, 5, 0), rows=301))
        with viewing(simulating, client, f"/view/{run}/t/1.0/key/{KEY}") as connection:
            panel = Panel(connection, last="Search")
            for time in (4.0, 12.5):
                places = panel.places(
                    lambda at=time: steer(client, run, time=at),
                    "/obstacles/0",
                    "/flights/nominal/vehicle",
                    "/flights/worst/vehicle",
                )
                assert places["/obstacles/0"]["position"] == pytest.approx((300, -40 + 5 * time, 0))
                for flight in ("nominal", "worst"):
                    assert places[f"/flights/{flight}/vehicle"]["position"][:2] == pytest.approx((20 * time, 5))
        with viewing(simulating, client, f"/view/{run}/t/1.0") as connection:
            received = frames_until(connection, b"Search")
        assert b"/tracks/0" in received
        assert b"intruder, d_min > 5 m" in received
        assert b"/obstacles/0-worst" not in received, "both flights have the same intruder: it is drawn once"


def test_an_intruder_that_answers_is_drawn_for_each_flight(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "pioneer_moving")
        work = Work(simulating)
        work.nominal(encounter("nominal", "enu", straight(300, -40, 0, 0, 5, 0)))
        work.found(flown=encounter("F1", "enu", straight(300, -40, 0, 1, 5, 0)))
        with viewing(simulating, client, f"/view/{run}/t/1.0/key/{KEY}") as connection:
            panel = Panel(connection, last="Search")
            places = panel.places(partial(steer, client, run, time=10.0), "/obstacles/0", "/obstacles/0-worst")
            assert places["/obstacles/0"]["position"] == pytest.approx((300, 10, 0))
            assert places["/obstacles/0-worst"]["position"] == pytest.approx((310, 10, 0))


def test_an_intruder_without_a_flight_is_not_drawn_standing(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "pioneer_moving")
        work = Work(simulating)
        with viewing(simulating, client, f"/view/{run}/") as connection:
            assert b"/obstacles/0" not in frames_until(connection, b"/goal/label", b"Search")
            work.nominal(encounter("nominal", "enu", straight(300, -40, 0, 0, 5, 0)))
            frames_until(connection, b"/tracks/0", b"intruder, d_min > 5 m")


def test_an_aircraft_is_drawn_upright_with_north_ahead_and_east_to_the_right(simulating: Service) -> None:
    with simulating.signed_in() as client:
        run = shipped(simulating, client, "uav_aca")
        work = Work(simulating)
        work.nominal(encounter("nominal", "ned", straight(500, 60, -30, -20, 0, -1)))
        with viewing(simulating, client, f"/view/{run}/t/1.0/key/{KEY}") as connection:
            panel = Panel(connection, last="Search")
            for time in (5.0, 14.0):
                places = panel.places(
                    partial(steer, client, run, time=time), "/obstacles/0", "/flights/nominal/vehicle"
                )
                own, other = places["/flights/nominal/vehicle"], places["/obstacles/0"]
                assert own["position"] == pytest.approx((5, 20 * time, 2 * time))
                assert other["position"] == pytest.approx((60, 500 - 20 * time, 30 + time))
            forward, left, up = (turned(own["wxyz"], axis) for axis in np.eye(3))
            assert forward == pytest.approx((0, np.cos(0.1), np.sin(0.1))), "nose up, to the north"
            assert left[2] == pytest.approx(np.cos(0.1) * np.sin(0.3)), "right wing down"
            assert left[0] < -0.9, "the left wing is in the west"
            assert up[2] > 0.9
        with viewing(simulating, client, f"/view/{run}/") as connection:
            received, drawn = b"", []
            for frame in frames(connection):
                received += frame
                drawn += msgspec.msgpack.decode(frame)["messages"]
                if b"Search" in received:
                    break
        assert b"/course" in received, "a plan of speed and heading instead of a goal"
        assert b"/goal/label" not in received
        # Labels are at their heights: the aircraft climbs from 0 to 40 m, the safety radius reaches further up.
        texts, heights = {}, {}
        for message in drawn:
            if message["type"] == "LabelMessage" and message["name"].startswith("/north/height/"):
                texts[message["name"]] = message["props"]["text"]
            if message["type"] == "SetPositionMessage" and message["name"].startswith("/north/height/"):
                heights[message["name"]] = message["position"][2]
        assert len(texts) >= 2
        assert "0 m" in texts.values(), "without a minus"
        for name, text in texts.items():
            assert float(text.removeprefix("height ").removesuffix(" m").replace("\u2212", "-")) == heights[name]
