"""Decision-making avoidance of intruders in space, by the rules of right of way.

Conflict (d_AB <= R_p while the range closes) and resolution (7.7) are as for the least deviation, but the rules
determine the side, and the aircraft with the right of way continues as planned:

    head-on      each turns right                      bearing of the other and its reciprocal course within `ahead`
    overtaking   the overtaker turns right             own position within `astern` of the other's tail
    overtaken    has the right of way                  other's position within `astern` of the own tail
    converging   the aircraft with the other on its right gives way and does not pass in front: turns right
                 the aircraft with the other on its left has the right of way

Rules are tried in this order. An aircraft with the right of way nevertheless acts when the time to the closest approach
is below `last_resort`, because the other does not give way. It then passes behind traffic from the left, and turns away
from overtaking traffic to the side that V_AB points to. A duty holds until its conflict is over: until another
intruder's is the earliest, or none comes closer within range.
The rules do not depend on altitude: all encounters are treated as if at about the same level.

Source: ICAO Annex 2, Rules of the Air, section 3.2.2 (3.2.2.2 head-on, 3.2.2.3 converging, 3.2.2.4 overtaking and its
70 degrees), named as future work by Srikanthakumar, section 8.2; conflict and resolution, section 7.2 there. `ahead`
and `last_resort` are chosen; the rules give no values. Readings, errors and limits as for the least deviation: V_A is
the planned velocity + (du, dpsi) unless `instant` is 1. Intended for guidance sampled at its own period. Axes with z
down.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter, extended
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.physics.resolution import (
    NEVER,
    Encounter,
    Plan,
    Sensing,
    aside,
    nan_guard,
    own_reading,
    perceive,
    planned,
    resolve,
)
from worker.engine.physics.space import Vector


class Rules(NamedTuple):
    ahead: Annotated[float, Parameter("rad", "Head-on: largest angle off the bow and off the reciprocal", 0.0, 1.6)] = (
        0.35
    )
    astern: Annotated[float, Parameter("rad", "Overtaking: largest angle off the tail", 0.0, 1.6)] = 1.2217304763960306
    last_resort: Annotated[
        float, Parameter("s", "Time to the closest approach below which the right of way is waived", 0.0, 1e5)
    ] = 12.0


RightOfWay = extended("RightOfWay", Sensing, Rules)
Memory = tuple[float, float]
"""The current duty, and the index of the intruder that it concerns."""

NO_DUTY, STANDS_ON, GIVES_WAY, OVERTAKEN = -1.0, 0.0, 1.0, 2.0


@kernel
def duty(e: Encounter, p: Any) -> float:
    """The duty under the rules: GIVES_WAY; to continue, STANDS_ON or OVERTAKEN."""
    own, other = norm2(e.own[0], e.own[1]), norm2(e.other[0], e.other[1])
    level = norm2(e.n[0], e.n[1])
    bow = (e.own[0] * e.n[0] + e.own[1] * e.n[1]) / (own * level + 1e-12)
    tail = (e.other[0] * e.n[0] + e.other[1] * e.n[1]) / (other * level + 1e-12)
    opposed = -(e.own[0] * e.other[0] + e.own[1] * e.other[1]) / (own * other + 1e-12)
    _, ahead = sincos(p.ahead)
    _, astern = sincos(p.astern)
    head_on = (bow > ahead) & (opposed > ahead)
    overtaking = tail > astern
    overtaken = bow < -astern
    on_right = e.own[0] * e.n[1] - e.own[1] * e.n[0] > 0.0
    what = GIVES_WAY if on_right else STANDS_ON
    what = OVERTAKEN if overtaken else what
    return GIVES_WAY if head_on | overtaking else what


class Soonest(NamedTuple):
    """The result of the obstacles considered so far: the earliest conflict, its resolving demand [m/s], the duty."""

    wait: float
    x: float
    y: float
    z: float
    flies_on: float
    duty: float
    number: float
    approached: float
    nan_guard: float


@kernel
def first(t: float, q: Vector, v: Vector, goal: Plan, m: Memory, p: Any) -> Soonest:
    return Soonest(NEVER, 0.0, 0.0, 0.0, 0.0, m[0], m[1], 0.0, 0.0 * (p.ahead + p.astern + p.last_resort))


@kernel
def weigh(
    s: Soonest, number: float, body: Any, t: float, q: Vector, v: Vector, goal: Plan, m: Memory, p: Any
) -> Soonest:
    e = perceive(q, v, own_reading(v, goal, p), body, p)
    near = e.near > 0.5
    known = (m[0] > -0.5) & (m[1] == number)
    what = m[0] if known else duty(e, p)
    gives_way = what == GIVES_WAY
    crossing = e.other[0] * e.right[0] + e.other[1] * e.right[1]
    behind = -1.0 if crossing > 0.0 else 1.0
    behind = 0.0 if what == OVERTAKEN else behind
    h, xi = aside(e, 1.0 if gives_way else behind)
    demand = resolve(e, h, xi)
    sooner = near & (e.miss <= p.radius) & (xi < e.turn) & (e.wait < s.wait)
    waits = 0.0 if gives_way | (e.wait <= p.last_resort) else 1.0
    return Soonest(
        e.wait if sooner else s.wait,
        demand[0] if sooner else s.x,
        demand[1] if sooner else s.y,
        demand[2] if sooner else s.z,
        waits if sooner else s.flies_on,
        what if sooner else s.duty,
        number if sooner else s.number,
        1.0 if near else s.approached,
        s.nan_guard + nan_guard(e, xi, p),
    )


@kernel
def steer(t: float, q: Vector, v: Vector, goal: Plan, s: Soonest, m: Memory, p: Any) -> tuple[Vector, Memory]:
    plan = planned(goal)
    acts = (s.wait < NEVER) & (s.flies_on < 0.5)
    out = (
        (s.x if acts else plan[0]) + s.nan_guard,
        (s.y if acts else plan[1]) + s.nan_guard,
        (s.z if acts else plan[2]) + s.nan_guard,
    )
    return out, (s.duty if s.approached > 0.5 else NO_DUTY, s.number)


@kernel
def remember(p: Any) -> Memory:
    return NO_DUTY, 0.0


component = Avoider(
    name="right_of_way_3d",
    title="Least deviation within the right of way",
    dimension=3,
    demand="velocity",
    parameters=RightOfWay,
    goal=Plan,
    memory=2,
    steer=steer,
    remember=remember,
    weigh=weigh,
    first=first,
    frame="ned",
)
