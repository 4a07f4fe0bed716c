"""Following cameras, velocities and trails against closed forms."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from backend.scenes.base.address import CAMERAS
from backend.scenes.base.flight import Closest, Flight, from_live, rate
from backend.scenes.drawing import cameras
from backend.scenes.drawing.bodies import bodies_of, nearest
from backend.scenes.drawing.cameras import Scene, Sight, pose
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.drawing.flights import Flights
from tests.given.finished_runs import encounter, straight

UNIT, THRESHOLD = 2.0, 10.0
SCENE = Scene(np.array([5.0, 5.0, 0.0]), np.array([[0.0, 0, 0], [10.0, 10, 0]]), THRESHOLD, UNIT)
SIGHT = Sight(
    vehicle=np.array([30.0, 40.0, 50.0]),
    forward=np.array([0.6, 0.0, 0.8]),
    obstacle=np.array([60.0, 80.0, 50.0]),
    reach=1.0,
    closest=Closest(3.0, 4.0, np.array([1.0, 2.0, 3.0]), np.array([5.0, 2.0, 3.0])),
)


def angle(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.degrees(np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other))))


def flown(way: object) -> Flight:
    trace = encounter("live", "ned", way)
    data = {column.name: trace.data[:, k].tolist() for k, column in enumerate(trace.columns)}
    columns = [column.model_dump() for column in trace.columns]
    found = from_live({"columns": columns, "data": data, "meta": trace.meta.model_dump(), "identity": {}})
    assert found is not None
    return found


def test_chase_is_behind_and_above_and_looks_ahead_level() -> None:
    eye, target = pose("chase", SCENE, SIGHT)
    assert eye - SIGHT.vehicle == pytest.approx((-6 * UNIT, 0, 2.4 * UNIT)), "behind a nose that points up, level"
    assert target - SIGHT.vehicle == pytest.approx((3 * UNIT, 0, 0))
    steep = replace(SIGHT, forward=np.array([0.0, 0.0, 1.0]))
    assert pose("chase", SCENE, steep)[0] - SIGHT.vehicle == pytest.approx((0, -6 * UNIT, 2.4 * UNIT))


def test_the_intruders_camera_looks_over_it_at_the_vehicle() -> None:
    eye, target = pose("intruder", SCENE, SIGHT)
    assert SIGHT.obstacle is not None
    assert target == pytest.approx(SIGHT.vehicle)
    back = 1.6 * THRESHOLD + 3 * UNIT
    assert eye - SIGHT.obstacle == pytest.approx((0.6 * back, 0.8 * back, 0.55 * back)), "on the line of the two"
    assert np.linalg.norm(eye - SIGHT.obstacle) > THRESHOLD
    assert angle(SIGHT.obstacle - eye, target - eye) < 20, "the obstacle is in the picture"


def test_a_camera_of_what_is_not_there_is_the_overview() -> None:
    overview = pose("overview", SCENE, None)
    for camera in ("chase", "intruder", "encounter"):
        for one, other in zip(pose(camera, SCENE, None), overview, strict=True):  # type: ignore[arg-type]
            assert one == pytest.approx(other)
    lonely = replace(SIGHT, obstacle=None, closest=None)
    for camera in ("intruder", "encounter"):
        assert pose(camera, SCENE, lonely)[0] == pytest.approx(overview[0])  # type: ignore[arg-type]


@pytest.mark.parametrize("camera", CAMERAS)
def test_no_camera_is_inside_what_it_shows(camera: str) -> None:
    above = replace(SIGHT, obstacle=SIGHT.vehicle - np.array([0.0, 0.0, 5.0]))
    for sight in (SIGHT, above):
        eye, target = pose(camera, SCENE, sight)  # type: ignore[arg-type]
        assert np.isfinite(eye).all()
        assert np.linalg.norm(eye - target) > UNIT


def test_level_of_a_vertical_direction_is_north() -> None:
    assert cameras.level(np.array([0.0, 0.0, -3.0])) == pytest.approx((0, 1, 0))
    assert cameras.level(np.array([3.0, 4.0, 9.0])) == pytest.approx((0.6, 0.8, 0))


def test_velocities_are_the_slopes_of_the_stored_places() -> None:
    flight = flown(straight(500, 60, -30, -20, 0, -1))
    for time in (0.0, 3.21, 20.0, 99.0):
        assert flight.velocity(time) == pytest.approx((0, 20, 2)), "north is ahead, up is up"
        assert flight.obstacle_velocity(0, time) == pytest.approx((0, -20, 1))
    assert flight.typical_speed == pytest.approx(np.sqrt(404))


def test_the_slope_of_a_parabola_is_exact_at_uneven_times() -> None:
    time = np.array([0.0, 0.5, 0.6, 2.0, 2.0, 5.0])
    slopes = rate(time, np.column_stack([3 * time**2, -time]))
    assert slopes[1:5, 0] == pytest.approx(6 * time[1:5])
    assert slopes[:, 1] == pytest.approx(-np.ones(6))
    assert rate(np.zeros(3), np.ones((3, 2))) == pytest.approx(np.zeros((3, 2)))


def test_the_relative_velocity_is_that_to_the_nearest_obstacle() -> None:
    flight = flown(straight(500, 60, -30, -20, 0, -1))
    values = {
        f"obstacles.{i}.position.{axis}": v
        for i, at in enumerate([(0, 0, 0), (0, 0, -9)])
        for axis, v in zip("xyz", at, strict=True)
    }
    bodies = bodies_of([None, None], values, flight)
    assert [body.flight is flight for body in bodies] == [True, False]
    place = np.array([0.0, 0.0, 8.0])
    still = nearest(bodies, place, 3.0)
    assert still is not None
    assert still.number == 1
    assert still.velocity(3.0) == pytest.approx((0, 0, 0))
    moving = nearest(bodies, bodies[0].at(3.0) + 1.0, 3.0)
    assert moving is not None
    assert moving.number == 0
    assert flight.velocity(3.0) - moving.velocity(3.0) == pytest.approx((0, 40, 1))
    assert nearest([], place, 0.0) is None


def test_a_flight_may_be_removed_while_the_camera_requests_it() -> None:
    """The camera asks in the thread of the view, requests of the page draw in others."""
    whole = flown(straight(500, 60, -30, -20, 0, -1))
    drawn, flights = Drawn.__new__(Drawn), Flights.__new__(Flights)
    nothing = SimpleNamespace(flight=None, visible=True)

    class Leaving:
        """A flight that is gone as soon as anything of it was read."""

        def __getattr__(self, name: str) -> Any:
            drawn.flight, drawn.bodies = None, []
            return getattr(whole, name)

    level = {"_world": SimpleNamespace(frame=SimpleNamespace(span=1.0)), "_setting": SimpleNamespace(planar=0)}
    drawn.__dict__.update(level, style=SimpleNamespace(layer=0), visible=True, flight=Leaving(), bodies=[])
    flights.__dict__.update(chosen=drawn, nominal=nothing, what_if=nothing)
    sight = flights.sight(1.0)
    assert sight is not None
    assert sight.vehicle == pytest.approx(whole.at(1.0)[0])
    assert sight.closest is whole.closest
    assert flights.sight(1.0) is None
