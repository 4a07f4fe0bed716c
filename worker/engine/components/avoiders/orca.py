"""Optimal reciprocal collision avoidance (ORCA) of one agent in the plane.

The velocity closest to the preferred one that avoids every disc for a time tau.

For each disc B, with r = p_B - q, w = v - v_B, R = radius of B + radius: u is the smallest change of w that leaves the
velocity obstacle {w : |r - w t| < R for some t in [0, tau]}, n its outward normal there, and the velocity must be in
the half-plane  (V - v - c u) . n >= 0.  c = 1/2 where B does the same, 1 where it does not.
The demand is the point of all half-planes and of the disc |V| <= v_max nearest to V_pref, which is of length `speed`
towards the goal, less within speed / k_goal of it. The vehicle leaves discs that already overlap within `escape`.
Source: van den Berg, Guy, Lin and Manocha, Reciprocal n-body collision avoidance (2011), sections 4 and 5.1. Of their
incremental linear program three steps are taken, each on the half-plane that is violated most: exact if at most three
are active at once; a fourth is ignored until it is among the worst three.
Approximated: where no velocity satisfies all (their section 5.3 makes the largest violation smallest), the half-plane
in question is satisfied and its violation of the others is split between the two that bound it, and the speed stays
within v_max. A box is replaced by its circumscribed disc. The robot cannot move sideways and takes time to follow:
`radius` needs a margin for that, which the method does not provide.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Order, Parameter
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.physics.fields import cruise
from worker.engine.physics.vectors import Goal


class Orca(NamedTuple):
    speed: Annotated[float, Parameter("m/s", "Preferred speed", 0.0, 1e3)] = 1.0
    v_max: Annotated[float, Parameter("m/s", "Greatest speed", 1e-3, 1e3)] = 1.5
    k_goal: Annotated[float, Parameter("1/s", "Speed per distance near the goal", 1e-3, 1e3)] = 1.0
    radius: Annotated[float, Parameter("m", "Own radius with margin", 0.0, 1e4)] = 0.5
    tau: Annotated[float, Parameter("s", "Time horizon of the avoidance", 1e-2, 1e4, symbol="τ")] = 5.0
    escape: Annotated[float, Parameter("s", "Time to leave an overlap", 1e-2, 1e4)] = 0.5
    c: Annotated[float, Parameter("", "Fraction of the change that the vehicle makes", 0.0, 1.0)] = 1.0


Pair = tuple[float, float]
Line = tuple[float, float, float, float]
PARALLEL = 1e-9
TOUCHING = 1e-9
"""Violations below this count as satisfied [m/s]."""


@kernel
def half_plane(body: Any, q: Pair, v: Pair, p: Orca) -> Line:
    """A point on the edge and the unit normal towards the permitted side."""
    rx = body.x - q[0]
    ry = body.y - q[1]
    vx = v[0] - body.vx
    vy = v[1] - body.vy
    R = body.radius + p.radius
    square = rx * rx + ry * ry
    apart = square > R * R
    per_time = 1.0 / (p.tau if apart else p.escape)
    wx = vx - per_time * rx
    wy = vy - per_time * ry
    w = norm2(wx, wy)
    ahead = wx * rx + wy * ry
    on_cap = ((ahead < 0.0) & (ahead * ahead > R * R * w * w)) | (square <= R * R)
    per_w = 1.0 / (w + 1e-300)
    cap_x, cap_y = wx * per_w, wy * per_w
    beyond = R * per_time - w
    tangent = square - R * R
    tangent = math.sqrt(0.0 if tangent < 0.0 else tangent)
    side = 1.0 if rx * wy - ry * wx > 0.0 else -1.0
    per_square = 1.0 / (square + 1e-300)
    leg_x = (side * rx * tangent - ry * R) * per_square
    leg_y = (rx * R + side * ry * tangent) * per_square
    along = vx * leg_x + vy * leg_y
    ux = beyond * cap_x if on_cap else along * leg_x - vx
    uy = beyond * cap_y if on_cap else along * leg_y - vy
    return v[0] + p.c * ux, v[1] + p.c * uy, cap_x if on_cap else -leg_y, cap_y if on_cap else leg_x


@kernel
def bounded(low: float, high: float, line: Line, other: Line) -> Pair:
    """The stretch of the edge of `line` from low to high, clipped to the half-plane `other`."""
    rate = other[2] * line[3] - other[3] * line[2]
    short = (other[0] - line[0]) * other[2] + (other[1] - line[1]) * other[3]
    crosses = abs(rate) > PARALLEL
    at = short / (rate if crosses else 1.0)
    low = at if crosses & (rate > 0.0) & (at > low) else low
    high = at if crosses & (rate < 0.0) & (at < high) else high
    return low, high


@kernel
def tightened(
    best: Pair, wish: Pair, last: Line, before: Line, q: Pair, v: Pair, bodies: Any, p: Orca
) -> tuple[Pair, Line]:
    """The point closest to `wish` that satisfies the half-plane most violated by `best`, and the previous ones."""
    worst, nan_guard = -TOUCHING, 0.0
    x, y, nx, ny = 0.0, 0.0, 0.0, 0.0
    for body in bodies:
        line = half_plane(body, q, v, p)
        outside = (best[0] - line[0]) * line[2] + (best[1] - line[1]) * line[3]
        nan_guard += 0.0 * outside  # a comparison with NaN is False and would lose it
        worse = outside < worst
        worst = outside if worse else worst
        x = line[0] if worse else x
        y = line[1] if worse else y
        nx = line[2] if worse else nx
        ny = line[3] if worse else ny
    # its edge is (x, y) + s (ny, -nx)
    middle = y * nx - x * ny
    reach = p.v_max * p.v_max - x * x - y * y + middle * middle
    reach = math.sqrt(0.0 if reach < 0.0 else reach)
    low, high = bounded(middle - reach, middle + reach, (x, y, nx, ny), last)
    low, high = bounded(low, high, (x, y, nx, ny), before)
    s = (wish[0] - x) * ny - (wish[1] - y) * nx
    s = low if s < low else s
    s = high if s > high else s
    s = 0.5 * (low + high) if low > high else s
    found = worst < -TOUCHING
    best_x = x + s * ny if found else best[0]
    best_y = y - s * nx if found else best[1]
    return (best_x + nan_guard, best_y + nan_guard), (x, y, nx, ny)


@kernel
def steer(t: float, q: Pair, v: Pair, goal: Goal, bodies: Any, memory: tuple[()], p: Orca) -> tuple[Pair, tuple[()]]:
    x = goal.x - q[0]
    y = goal.y - q[1]
    k = cruise(norm2(x, y), p.v_max if p.speed > p.v_max else p.speed, p.k_goal)
    wish = (k * x, k * y)
    none = (0.0, 0.0, 0.0, 0.0)
    best, first = tightened(wish, wish, none, none, q, v, bodies, p)
    # their number is a compile-time constant, so these are not branches
    if len(bodies) > 1:
        best, second = tightened(best, wish, first, none, q, v, bodies, p)
        if len(bodies) > 2:
            best, _ = tightened(best, wish, second, first, q, v, bodies, p)
    excess = p.v_max / (norm2(best[0], best[1]) + 1e-300)
    scale = 1.0 if excess > 1.0 else excess
    nan_guard = 0.0 * (p.tau + p.escape)
    return (scale * best[0] + nan_guard, scale * best[1] + nan_guard), ()


component = Avoider(
    name="orca",
    title="Velocity obstacles (ORCA)",
    dimension=2,
    demand="velocity",
    parameters=Orca,
    goal=Goal,
    memory=0,
    steer=steer,
    # with c = 0 the half-plane of any disc, however far, goes through the own velocity
    orders=(Order((), ("c",), "below 0.01 discs restrict it however far they are; give c of at least 0.01", 100.0),),
)
