"""Geometry of the scene: axes, bodies, tracks, the bounding box for cameras."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from backend.reports import plot
from backend.reports.figures import Case, Quantity
from backend.reports.plan_view import plan_view
from backend.scenes.base.axes import Axes, along, axes_of
from backend.scenes.base.flight import Closest, from_live
from backend.scenes.base.setting import _climbs, _course
from backend.scenes.drawing import shapes
from backend.scenes.drawing.bodies import body_of
from backend.scenes.drawing.cameras import distance
from backend.scenes.drawing.drawn import beyond, ruler
from backend.scenes.drawing.world import Frame
from campaigns import Campaign
from campaigns.results import TraceHead
from tests.given.finished_runs import encounter, straight, turned
from tests.given.small_catalogue import CATALOGUE, campaign

TO_EAST_NORTH_UP = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])


def flown(**changes: object) -> object:
    """A flight with an intruder, as the simulation process answers."""
    trace = encounter("live", "ned", straight(500, 60, -30, -20, 0, -1), **changes)  # type: ignore[arg-type]
    data = {c.name: trace.data[:, k].tolist() for k, c in enumerate(trace.columns)}
    return from_live(
        {
            "columns": [c.model_dump() for c in trace.columns],
            "data": data,
            "meta": trace.meta.model_dump(),
            "identity": {},
        }
    )


@pytest.mark.parametrize("rotation", [(0, 0, 0), (0.4, -0.3, 2.5), (-2.9, 0.7, -1.2), (0.1, 1.5, 0.3)])
def test_an_attitude_with_z_down_is_the_matrix_of_flight_mechanics(rotation: tuple[float, float, float]) -> None:
    (cr, cp, cy), (sr, sp, sy) = np.cos(rotation), np.sin(rotation)
    to_world = (
        np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
        @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    )
    drawn = TO_EAST_NORTH_UP @ to_world @ np.diag([1, -1, -1])
    assert np.linalg.det(drawn) == pytest.approx(1), "turned, not mirrored"
    wxyz = Axes("ned").attitude(np.array(rotation))
    for axis, column in zip(np.eye(3), drawn.T, strict=True):
        assert turned(wxyz, axis) == pytest.approx(column, abs=1e-12)


@pytest.mark.parametrize("turns", [None, np.array([2.0, 0.0, 1.0, -1.0])])
@pytest.mark.parametrize("frame", ["enu", "ned"])
def test_attitudes_are_those_at_the_times_of_the_rows(frame: str, turns: np.ndarray | None) -> None:
    flight: Any = flown(rows=9)
    yaw = np.linspace(3.0, 3.5, 9) % (2 * np.pi) - np.where(np.arange(9) > 4, 2 * np.pi, 0.0)  # past half a turn
    rotation = np.column_stack([np.linspace(-0.2, 0.3, 9), np.linspace(0.4, 0.1, 9), yaw])
    given = None if turns is None else turns + np.linspace(0.0, 0.5, 9)[:, None]
    flight = replace(flight, axes=axes_of(frame), rotation=rotation, turns=given)
    expected = [flight.at(float(time))[1].tolist() for time in flight.time]
    assert flight.attitudes.tolist() == expected
    assert np.linalg.norm(flight.attitudes, axis=1) == pytest.approx(1.0)


def test_positions_with_z_down_are_drawn_east_north_up() -> None:
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 5.0, -6.0]])
    assert Axes("ned").drawn(points) == pytest.approx(points @ TO_EAST_NORTH_UP.T)
    assert Axes("enu").drawn(points) is points


def test_a_direction_is_looked_along_with_wings_level() -> None:
    direction = np.array([-1.0, 2.0, -0.5])
    wxyz = along(direction)
    assert turned(wxyz, np.array([1.0, 0, 0])) == pytest.approx(direction / np.linalg.norm(direction))
    assert turned(wxyz, np.array([0, 1.0, 0]))[2] == pytest.approx(0)
    assert along(np.zeros(3)) == pytest.approx((1, 0, 0, 0))


def test_bodies_are_what_their_parameters_say() -> None:
    at = {"obstacles.0.position.x": 1.0, "obstacles.0.position.y": 2.0, "obstacles.0.position.z": -3.0}
    ned = Axes("ned")
    ball = body_of(0, at | {"obstacles.0.radius": 4.0}, ned, None)
    assert (ball.kind, ball.size, ball.extent) == ("round", (4.0,), 4.0)
    assert ball.place == pytest.approx((2, 1, 3))
    tower = body_of(0, at | {"obstacles.0.radius": 3.0, "obstacles.0.height": 8.0}, ned, None)
    assert (tower.kind, tower.size, tower.extent) == ("cylinder", (3.0, 8.0), 5.0)
    sides = {"obstacles.0.length": 2.0, "obstacles.0.width": 3.0, "obstacles.0.height": 6.0, "obstacles.0.angle": 0.3}
    box = body_of(0, at | sides, ned, None)
    assert (box.kind, box.size, box.extent) == ("box", (2.0, 3.0, 6.0), 3.5)
    assert turned(box.turn, np.array([1.0, 0, 0])) == pytest.approx((np.sin(0.3), np.cos(0.3), 0)), (
        "from north over east"
    )


def test_a_body_of_a_flight_is_where_the_trace_has_it() -> None:
    flight = flown()
    body = body_of(0, {"obstacles.0.radius": 1.0}, Axes("ned"), flight)  # type: ignore[arg-type]
    assert body.at(0.0) == pytest.approx((60, 500, 30))
    assert body.at(7.3) == pytest.approx((60, 500 - 20 * 7.3, 30 + 7.3))
    assert body.at(99.0) == pytest.approx((60, 100, 50)), "held after the flight"
    for time in (0.0, 5.0, 99.0):
        step = body.heading(time)
        assert step / np.linalg.norm(step) == pytest.approx(np.array([0, -20, 1]) / np.sqrt(401))


def test_traces_share_a_body_only_where_its_motion_is_the_same() -> None:
    def body(**changes: float) -> object:
        values = {"obstacles.0.radius": changes.get("radius", 1.0)}
        way = straight(500, 60, -30, -20, changes.get("drift", 0.0), -1)
        trace = encounter("live", "ned", way, rows=int(changes.get("rows", 401)))
        data = {c.name: trace.data[:, k].tolist() for k, c in enumerate(trace.columns)}
        flight = from_live(
            {
                "columns": [c.model_dump() for c in trace.columns],
                "data": data,
                "meta": trace.meta.model_dump(),
                "identity": {},
            }
        )
        return body_of(0, values, Axes("ned"), flight)

    one = body()
    assert one.like(body(rows=233), 500.0)  # type: ignore[attr-defined]
    assert not one.like(body(drift=0.1), 500.0)  # type: ignore[attr-defined]
    assert not one.like(body(radius=1.1), 500.0)  # type: ignore[attr-defined]


def test_a_track_is_cut_into_dashes_of_one_length() -> None:
    corner = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0]])
    dashes = shapes.dashed(corner, 1.0)
    assert dashes.shape == (10, 2, 3)
    assert np.linalg.norm(dashes[:, 1] - dashes[:, 0], axis=1) == pytest.approx(np.ones(10))
    assert dashes[5, 0] == pytest.approx((10, 0, 0))
    assert len(shapes.dashed(corner, 1e-9)) <= 401
    assert len(shapes.dashed(np.zeros((5, 3)), 1.0)) == 0


@pytest.mark.parametrize(
    "mesh", [*shapes.aircraft(), *shapes.pioneer(), *shapes.unicycle(), *shapes.body(), shapes.arrow()]
)
def test_meshes_are_about_one_unit_large_and_whole(mesh: shapes.Mesh) -> None:
    assert np.abs(mesh.vertices).max() <= 1.0
    assert set(np.unique(mesh.faces)) <= set(range(len(mesh.vertices)))


def test_an_aircraft_has_its_fin_on_top_and_its_nose_ahead() -> None:
    front, back = shapes.aircraft()
    assert front.vertices[:, 0].max() == pytest.approx(0.5)
    assert back.vertices[:, 0].max() < -0.2
    assert back.vertices[:, 2].max() > 0.2 > -0.1 < back.vertices[:, 2].min()
    assert front.vertices[:, 1].max() == pytest.approx(-front.vertices[:, 1].min())


def test_a_capsule_keeps_its_radius_about_its_axis() -> None:
    vertices = shapes.capsule(5.0, 20.0).vertices
    nearest = np.clip(vertices[:, 2], -10, 10)
    assert np.hypot(np.hypot(vertices[:, 0], vertices[:, 1]), vertices[:, 2] - nearest) == pytest.approx(
        np.full(len(vertices), 5.0)
    )


@pytest.mark.parametrize("direction", [(-0.25, -0.75, 0.8), (0.0, -1e-3, 1.0), (0.0, -1.0, 0.12)])
def test_the_camera_sees_every_point(direction: tuple[float, float, float]) -> None:
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3)) * (400, 30, 80)
    towards = np.array(direction) / np.linalg.norm(direction)
    eye = distance(points, towards) * towards
    seen = points - eye
    ahead = -seen @ towards
    off = np.linalg.norm(seen + np.outer(ahead, towards), axis=1)
    assert (ahead > 0).all()
    assert (np.degrees(np.arctan2(off, ahead)) < 40).all()


def test_signs_are_to_be_seen_but_no_longer_than_what_must_stay_free() -> None:
    box = [np.zeros(3), np.array([800.0, 400.0, 10.0])]
    assert Frame.around(box, 20.0).unit == pytest.approx(20.0)
    assert Frame.around(box, 18.0).unit == pytest.approx(20.0)
    assert Frame.around(box, 500.0).unit == pytest.approx(50.0)


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_what_must_stay_free_about_a_box_is_everywhere_as_far_from_its_edge(angle: float) -> None:
    turn = Axes().about_vertical(angle)
    dashes = shapes.rounded(np.array([5.0, 6.0, 0.1]), (16.0, 0.2), turn, 0.5)
    assert len(dashes) > 10
    points = dashes.reshape(-1, 3) - (5.0, 6.0, 0.1)
    along_it = points @ (np.cos(angle), np.sin(angle), 0.0)
    across = points @ (-np.sin(angle), np.cos(angle), 0.0)
    outside = np.maximum(np.abs(np.column_stack([along_it, across])) - (8.0, 0.1), 0.0)
    assert np.linalg.norm(outside, axis=1) == pytest.approx(0.5, abs=1e-3)
    assert points[:, 2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("obstacle", "ring"),
    [({"free_radius": 0.5}, 0.5), ({"free_radius": 1.75}, 1.75), ({"free_radius": None}, None)],
)
def test_a_report_draws_what_must_stay_free_as_the_flight_has_it(
    obstacle: dict[str, object], ring: float | None
) -> None:
    described = {"position": [3.0, 2.0, 0.0], "radius": 1.0, "moving": False} | obstacle
    shown = TraceHead.model_validate({"frame": "enu", "obstacles": [described]})
    data = {"x": [0.0, 3.0, 6.0], "y": [0.0, 0.0, 0.0], "separation": [3.0, 1.0, 3.0]}
    drawn = str(plan_view([Case("F1", plot.WORST, shown, data)], Quantity("c_min", "m", 0.5)))  # type: ignore[arg-type]
    body, *rings = [float(r) for r in re.findall(r'<circle[^>]* r="([0-9.]+)"[^>]*stroke-width="1"', drawn)]
    assert [r / body for r in rings] == pytest.approx([] if ring is None else [ring], abs=0.02)


@pytest.mark.parametrize(
    ("written_in", "frame", "up"),
    [("ned", "ned", 1), ("enu", "enu", 1), ("", "ned", 1), ("ned", "enu", -1), ("enu", "ned", -1)],
)
def test_a_planned_climb_is_drawn_as_it_is_simulated(written_in: str, frame: str, up: int) -> None:
    avoiders = [c.model_copy(update={"written_in": written_in}) for c in CATALOGUE.components if c.role == "avoider"]
    known = CATALOGUE.model_copy(update={"components": avoiders})
    axes = axes_of(frame)
    values = {"start.x": 0.0, "start.y": 0.0, "goal.speed": 10.0, "goal.heading": 0.0, "goal.climb": 0.5}
    end = _course(values, axes, 2.0, _climbs(Campaign.model_validate(campaign()), known, axes))
    assert end is not None
    assert end[2] == pytest.approx(up * 20.0 * np.sin(0.5))


AT = {"obstacles.0.position.x": 1.0, "obstacles.0.position.y": 2.0, "obstacles.0.position.z": 3.0}


@pytest.mark.parametrize(
    ("sizes", "place", "end"),
    [
        ({"radius": 2.0}, (1, 7, 3), (1, 4, 3)),
        ({"radius": 2.0}, (1, 3, 3), (1, 4, 3)),
        ({"radius": 2.0}, (1, 2, 3), (3, 2, 3)),
        ({"radius": 3.0, "height": 8.0}, (1, 7, 5), (1, 5, 5)),
        ({"radius": 3.0, "height": 8.0}, (1, 3, 12), (1, 3, 7)),
        ({"radius": 3.0, "height": 8.0}, (5, 5, 9), (3.4, 3.8, 7)),
        ({"radius": 3.0, "height": 8.0}, (1, 2, 6), (1, 2, 7)),
        ({"length": 2.0, "width": 6.0, "height": 4.0}, (9, 3, 3), (2, 3, 3)),
        ({"length": 2.0, "width": 6.0, "height": 4.0}, (9, 9, 9), (2, 5, 5)),
        ({"length": 2.0, "width": 6.0, "height": 4.0}, (0.9, 2, 3), (0, 2, 3)),
        ({"length": 2.0, "width": 6.0, "height": 4.0, "angle": np.pi / 2}, (9, 2, 3), (4, 2, 3)),
        ({"length": 2.0, "width": 6.0, "height": 0.0}, (1.2, 2, 3), (2, 2, 3)),
    ],
)
def test_the_nearest_point_of_a_surface(
    sizes: dict[str, float], place: tuple[float, ...], end: tuple[float, ...]
) -> None:
    """Outside, inside and at the centre of each shape; a box of the plane has no height."""
    body = body_of(0, AT | {f"obstacles.0.{name}": size for name, size in sizes.items()}, Axes("enu"), None)
    assert body.surface(np.array(place, dtype=float), body.place) == pytest.approx(end, abs=1e-12)


@pytest.mark.parametrize("body_radius", [0.0, 0.4])
@pytest.mark.parametrize("x", [-2.0, 0.8, 2.1, 6.0])
def test_a_ruler_is_as_long_as_the_distance_it_shows(x: float, body_radius: float) -> None:
    """To the surface from the vehicle's body, however deep the vehicle is inside; otherwise between centres."""
    body = body_of(0, AT | {"obstacles.0.radius": 1.5}, Axes("enu"), None)
    position = np.array([x, 2.0, 3.0])
    gap = abs(x - 1.0) - 1.5 - body_radius
    closest = Closest(1.0, gap, position, body.place, 0)
    near, far = ruler(closest, [body], body_radius)
    assert np.linalg.norm(near - far) == pytest.approx(abs(gap))
    assert np.linalg.norm(far - body.place) == pytest.approx(1.5), "on the surface"
    assert np.linalg.norm(near - position) == pytest.approx(body_radius), "at the edge of the vehicle's body"
    assert ruler(closest, [body], None) == (closest.position, closest.obstacle)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("vehicle", [(3.0, 5.0, 2.0), (-3.0, -5.0, -2.0), (0.0, 0.0, 4.0), (0.0, 0.0, 0.0)])
def test_a_label_beyond_an_obstacle_is_never_below_it_where_the_obstacle_has_its_own(
    vehicle: tuple[float, float, float], planar: bool
) -> None:
    obstacle = np.array([0.0, 0.0, 0.0])
    place, anchor = beyond(Closest(1.0, 1.0, np.array(vehicle), obstacle), 0.5, planar)
    assert place[1 if planar else 2] >= 0.0
    assert place[0] * vehicle[0] <= 0.0, "on the far side"
    assert anchor == ("center-right" if vehicle[0] > 0 else "center-left")
    assert np.linalg.norm(place) == pytest.approx(0.7 if any(vehicle) else 0.0)
