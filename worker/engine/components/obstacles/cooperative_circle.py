"""Circle that gives way: moves to its goal and resolves a conflict with the vehicle at their point of closest approach.

    dc/dt = v,   dv/dt = (U - v) / T

U is the velocity towards its goal, of `speed` and, near the goal, k_goal times the distance; in a conflict
the one from vector sharing (worker/engine/physics/closest.py), with the vehicle's true position and velocity. With
sharing = 0 it makes the whole manoeuvre, with 1 its fraction by the rule; with clearance = 0 it never gives way.
It ignores other obstacles. T is a first-order lag; there is no minimum turn radius.
Source: Park, Oh and Tahk (2008); Srikanthakumar, equations 2.17 to 2.20.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Rate, Reach
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body, Body3
from worker.engine.physics.closest import NEVER, Rules, resolve
from worker.engine.physics.fields import cruise
from worker.engine.physics.vectors import (
    Vector,
    difference,
    halves,
    like,
    norm,
    right_of,
    round_body,
    scaled,
    spatial,
)


class CooperativeCircle(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre at the start, x", -1e6, 1e6, "x", "position.x")]
    position_y: Annotated[float, Parameter("m", "Centre at the start, y", -1e6, 1e6, "y", "position.y")]
    goal_x: Annotated[float, Parameter("m", "Goal, x", -1e6, 1e6, "x_g", "goal.x")]
    goal_y: Annotated[float, Parameter("m", "Goal, y", -1e6, 1e6, "y_g", "goal.y")]
    speed: Annotated[float, Parameter("m/s", "Speed towards the goal", 0.0, 1e3, symbol="v_o")] = 1.0
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 1e5, symbol="r")] = 0.5
    clearance: Annotated[float, Parameter("m", "Clearance, centre to centre", 0.0, 1e5)] = 1.5
    horizon: Annotated[float, Parameter("s", "Time horizon of conflicts", 1e-2, 1e5)] = 10.0
    sharing: Annotated[float, Parameter("", "Fraction left to the vehicle: 0 nothing, 1 by the rule", 0.0, 1.0)] = 1.0
    k_goal: Annotated[float, Parameter("1/s", "Speed per distance near the goal", 1e-3, 1e3)] = 1.0
    lag: Annotated[float, Parameter("s", "Time constant of its velocity", 1e-3, 1e3, symbol="T")] = 0.5


PLANAR = len(CooperativeCircle._fields)


@kernel
def ends(p: Any) -> tuple[Vector, Vector]:
    """The position at the start and the goal; in space the parameters have a z for each."""
    if len(p) == PLANAR:
        return (p.position_x, p.position_y), (p.goal_x, p.goal_y)
    return (p.position_x, p.position_y, p.position_z), (p.goal_x, p.goal_y, p.goal_z)


@kernel
def to_goal(at: Vector, p: Any) -> tuple[Vector, Vector]:
    """The displacement to the goal, and the velocity towards it."""
    way = difference(ends(p)[1], at)
    return way, scaled(cruise(norm(way), p.speed, p.k_goal), way)


@kernel
def wake(p: Any) -> Vector:
    at = ends(p)[0]
    return (*at, *to_goal(at, p)[1])


@kernel
def move(t: float, o: Vector, q: Vector, v: Vector, p: Any) -> Vector:
    at, velocity = halves(o)
    way, towards = to_goal(at, p)
    own, now = spatial(towards), spatial(velocity)
    rules = Rules(p.clearance, p.horizon, p.sharing)
    tau, u = resolve(spatial(difference(q, at)), own, spatial(v), right_of(way), rules)
    conflict = tau < NEVER
    nan_guard = 0.0 * tau  # NaN if a conflict cannot be determined
    per_lag = 1.0 / p.lag
    rates = (
        per_lag * ((u[0] if conflict else own[0]) - now[0] + nan_guard),
        per_lag * ((u[1] if conflict else own[1]) - now[1] + nan_guard),
        per_lag * ((u[2] if conflict else own[2]) - now[2] + nan_guard),
    )
    return (*velocity, *like(rates, q))


@kernel
def body(t: float, o: Vector, q: Vector, p: Any) -> Body | Body3:
    return round_body(*halves(o), p.radius, q)


component = Obstacle(
    name="cooperative_circle",
    title="Circle that gives way",
    dimension=2,
    parameters=CooperativeCircle,
    body=body,
    states=4,
    wake=wake,
    move=move,
    moving=True,
    reach=Reach(("radius",)),
    rate=Rate(per=("lag",)),
    look=ObstacleLook(shape="circle", radius="radius", way="goal"),
)
