"""Circle that gives way: moves to its goal and resolves a conflict with the vehicle at their point of closest approach.

    dc/dt = v,   dv/dt = (U - v) / T

U is the velocity towards its goal, of `speed` and, near the goal, k_goal times the distance; in a conflict
the one from vector sharing (worker/engine/physics/closest.py), with the vehicle's true position and velocity. With
sharing = 0 it makes the whole manoeuvre, with 1 its fraction by the rule; with clearance = 0 it never gives way.
It ignores other obstacles. T is a first-order lag; there is no minimum turn radius.
Source: Park, Oh and Tahk (2008); Srikanthakumar, equations 2.17 to 2.20.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from worker.engine.kernels.component import Obstacle, ObstacleLook, Parameter, Reach
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.kernels.views import Body
from worker.engine.physics.closest import NEVER, Rules, resolve
from worker.engine.physics.fields import cruise
from worker.engine.physics.shapes import disc


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


State = tuple[float, float, float, float]
Vector = tuple[float, float]


@kernel
def to_goal(at: Vector, p: CooperativeCircle) -> tuple[Vector, float]:
    """The displacement to the goal, and the velocity per displacement."""
    x = p.goal_x - at[0]
    y = p.goal_y - at[1]
    return (x, y), cruise(norm2(x, y), p.speed, p.k_goal)


@kernel
def wake(p: CooperativeCircle) -> State:
    at = (p.position_x, p.position_y)
    way, k = to_goal(at, p)
    return at[0], at[1], k * way[0], k * way[1]


@kernel
def move(t: float, o: State, q: Vector, v: Vector, p: CooperativeCircle) -> State:
    way, k = to_goal((o[0], o[1]), p)
    own = (k * way[0], k * way[1], 0.0)
    flat = 1.0 / (norm2(way[0], way[1]) + 1e-12)
    right = (way[1] * flat, -way[0] * flat, 0.0)
    tau, u = resolve(
        (q[0] - o[0], q[1] - o[1], 0.0), own, (v[0], v[1], 0.0), right, Rules(p.clearance, p.horizon, p.sharing)
    )
    conflict = tau < NEVER
    nan_guard = 0.0 * tau  # NaN if a conflict cannot be determined
    per_lag = 1.0 / p.lag
    return (
        o[2],
        o[3],
        per_lag * ((u[0] if conflict else own[0]) - o[2] + nan_guard),
        per_lag * ((u[1] if conflict else own[1]) - o[3] + nan_guard),
    )


@kernel
def body(t: float, o: State, q: Vector, p: CooperativeCircle) -> Body:
    return disc((o[0], o[1]), (o[2], o[3]), p.radius, q)


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
    look=ObstacleLook(shape="circle", radius="radius", way="goal"),
)
