"""Circle along waypoints: from its position via up to four waypoints at constant speed; it stops at the last one.

It turns instantly at a waypoint. Before t = 0 it is on the extension of its first leg. It never gives way. `legs` is
the number of waypoints used; the others are ignored. Avoiders keep clear of its radius; `separation` measures distances
to its centre.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Derived, Obstacle, ObstacleLook, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.paths import Point, elapsed, leg, under_way
from worker.engine.physics.vectors import Vector, like, round_body


class WaypointCircle(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre at the start, x", -1e6, 1e6, "x", "position.x")]
    position_y: Annotated[float, Parameter("m", "Centre at the start, y", -1e6, 1e6, "y", "position.y")]
    to1_x: Annotated[float, Parameter("m", "Waypoint 1, x", -1e6, 1e6, "x_1", "waypoint1.x")]
    to1_y: Annotated[float, Parameter("m", "Waypoint 1, y", -1e6, 1e6, "y_1", "waypoint1.y")]
    to2_x: Annotated[float, Parameter("m", "Waypoint 2, x", -1e6, 1e6, "x_2", "waypoint2.x")] = 0.0
    to2_y: Annotated[float, Parameter("m", "Waypoint 2, y", -1e6, 1e6, "y_2", "waypoint2.y")] = 0.0
    to3_x: Annotated[float, Parameter("m", "Waypoint 3, x", -1e6, 1e6, "x_3", "waypoint3.x")] = 0.0
    to3_y: Annotated[float, Parameter("m", "Waypoint 3, y", -1e6, 1e6, "y_3", "waypoint3.y")] = 0.0
    to4_x: Annotated[float, Parameter("m", "Waypoint 4, x", -1e6, 1e6, "x_4", "waypoint4.x")] = 0.0
    to4_y: Annotated[float, Parameter("m", "Waypoint 4, y", -1e6, 1e6, "y_4", "waypoint4.y")] = 0.0
    legs: Annotated[float, Parameter("", "Number of waypoints used: 1 to 4, rounded", 1.0, 4.0)] = 4.0
    speed: Annotated[float, Parameter("m/s", "Speed", 0.0, 1e3, symbol="v_o")] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5


Constants = namedtuple(
    "Constants",
    "x y z vx_1 vy_1 vz_1 vx_2 vy_2 vz_2 vx_3 vy_3 vz_3 vx_4 vy_4 vz_4 ends_1 ends_2 ends_3 ends_4 radius",
)
"""The start, the velocity on each leg, and when each ends; in the plane every z is 0."""

PLANAR = len(WaypointCircle._fields)


@kernel
def corners(p: Any) -> tuple[Point, Point, Point, Point, Point]:
    """The start and the waypoints; in space the parameters have a z for each."""
    if len(p) == PLANAR:
        return (
            (p.position_x, p.position_y, 0.0),
            (p.to1_x, p.to1_y, 0.0), (p.to2_x, p.to2_y, 0.0), (p.to3_x, p.to3_y, 0.0), (p.to4_x, p.to4_y, 0.0),
        )  # fmt: skip
    return (
        (p.position_x, p.position_y, p.position_z),
        (p.to1_x, p.to1_y, p.to1_z), (p.to2_x, p.to2_y, p.to2_z), (p.to3_x, p.to3_y, p.to3_z),
        (p.to4_x, p.to4_y, p.to4_z),
    )  # fmt: skip


@kernel
def derive(p: Any, trim: object) -> tuple[float, ...]:
    start, to_1, to_2, to_3, to_4 = corners(p)
    leg_1 = leg(start, to_1, p.speed, 0.0, True)
    leg_2 = leg(to_1, to_2, p.speed, leg_1[4], p.legs > 1.5)
    leg_3 = leg(to_2, to_3, p.speed, leg_2[4], p.legs > 2.5)
    leg_4 = leg(to_3, to_4, p.speed, leg_3[4], p.legs > 3.5)
    # a comparison with NaN is False: 0 times the legs propagates it
    return (
        start[0] + 0.0 * p.legs, start[1], start[2],
        leg_1[0], leg_1[1], leg_1[2],
        leg_2[0], leg_2[1], leg_2[2],
        leg_3[0], leg_3[1], leg_3[2],
        leg_4[0], leg_4[1], leg_4[2],
        leg_1[4], leg_2[4], leg_3[4], leg_4[4], p.radius,
    )  # fmt: skip


@kernel
def body(t: float, o: tuple[()], q: Vector, p: Constants) -> Body | Body3:
    # Before the start too, where latency observes it.
    s_1 = t if t < p.ends_1 else p.ends_1
    on_1 = 1.0 if t < p.ends_1 else 0.0
    s_2 = elapsed(t, p.ends_1, p.ends_2)
    on_2 = under_way(t, p.ends_1, p.ends_2)
    s_3 = elapsed(t, p.ends_2, p.ends_3)
    on_3 = under_way(t, p.ends_2, p.ends_3)
    s_4 = elapsed(t, p.ends_3, p.ends_4)
    on_4 = under_way(t, p.ends_3, p.ends_4)
    x = p.x + p.vx_1 * s_1 + p.vx_2 * s_2 + p.vx_3 * s_3 + p.vx_4 * s_4
    y = p.y + p.vy_1 * s_1 + p.vy_2 * s_2 + p.vy_3 * s_3 + p.vy_4 * s_4
    z = p.z + p.vz_1 * s_1 + p.vz_2 * s_2 + p.vz_3 * s_3 + p.vz_4 * s_4
    vx = p.vx_1 * on_1 + p.vx_2 * on_2 + p.vx_3 * on_3 + p.vx_4 * on_4
    vy = p.vy_1 * on_1 + p.vy_2 * on_2 + p.vy_3 * on_3 + p.vy_4 * on_4
    vz = p.vz_1 * on_1 + p.vz_2 * on_2 + p.vz_3 * on_3 + p.vz_4 * on_4
    return round_body(like((x, y, z), q), like((vx, vy, vz), q), p.radius, q)


component = Obstacle(
    name="waypoint_circle",
    title="Circle, waypoints",
    dimension=2,
    parameters=WaypointCircle,
    body=body,
    moving=True,
    derived=Derived(Constants, derive),
    reach=Reach(("radius",)),
    rate=Rate(("speed",), legs=("position", "waypoint1", "waypoint2", "waypoint3", "waypoint4"), used="legs"),
    look=ObstacleLook(shape="circle", radius="radius", way="waypoints"),
)
