"""Decision-making avoidance of intruders by the smallest change of velocity, in space.

    V_AB = V_A - V_B,   d_AB = |r| sin(angle of V_AB and r)                           (7.1)
    conflict: d_AB <= R_p while the range closes                                      (7.2)
    V_d = |V_AB| cos(eta - xi) [cos(eta) r^ + sin(eta) h^] + V_B                      (7.7)

r: from the own position to the intruder; xi: angle of V_AB from r towards h^; eta = asin(R_p / |r|), at most eta_max;
h^: unit vector perpendicular to r, to the side taken. Without a conflict the planned velocity is kept. Of several
conflicts the one with the earliest closest approach is resolved.

side   -1 left, 1 right of the line of sight in the horizontal, committed; 0 free: the side V_AB already points to
       (7.7); 2 the side it points to at the first sample of a conflict, committed for the flight
gate   0 acts on every intruder that comes closer within range; 1 while d_AB <= R_p; 2 from the first d_AB <= R_p on,
       until none comes closer; 3 while xi < eta, then holds the last demand; 4 while xi < eta, otherwise as planned

V_A and V_B are measured with errors: own speed + du at the track + dpsi, the intruder's speed + du0 at its track turned
by dpsi0, anticlockwise seen from above. V_A is the planned velocity, unless `instant` is 1. Range and its rate are
exact.
Source: Srikanthakumar, section 7.2; equation 7.7 is 0/0 at xi = 0, the form above equals it elsewhere.
Reconstructed: R_p (planning) separate from the safe radius, range, eta_max, side, gate, "readings at the nominal case"
as the planned velocity, and the sense of dpsi0. Intended for guidance sampled at its own period. Axes with z down.
Limits: pairwise; velocities are assumed constant; a committed side is the least change among level courses only; the
aircraft's envelope and dynamics are handled by its autopilot.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Avoider, Parameter, extended
from worker.engine.kernels.maths import kernel, whole
from worker.engine.physics.resolution import (
    NEVER,
    Plan,
    Sensing,
    aside,
    nan_guard,
    own_reading,
    perceive,
    planned,
    resolve,
)
from worker.engine.physics.space import Vector, dot3


class Choice(NamedTuple):
    side: Annotated[
        float, Parameter("", "Side taken, rounded: -1 left, 1 right, 0 free, 2 as at first", -1.0, 2.0)
    ] = -1.0
    gate: Annotated[float, Parameter("", "When it acts: 0 to 4, rounded, see above", 0.0, 4.0)] = 4.0


MinimumDeviation = extended("MinimumDeviation", Sensing, Choice)
Memory = tuple[float, float, float, float, float, float]
"""Latched, committed side (0: none yet), last demand (3) [m/s], whether there is one."""


class Soonest(NamedTuple):
    """The result of the obstacles considered so far: the earliest conflict, and the demand that resolves it [m/s]."""

    wait: float
    x: float
    y: float
    z: float
    passed: float
    side: float
    approached: float
    latched: float
    nan_guard: float


@kernel
def first(t: float, q: Vector, v: Vector, goal: Plan, m: Memory, p: Any) -> Soonest:
    return Soonest(NEVER, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, m[0], 0.0 * (p.side + p.gate))


@kernel
def weigh(
    s: Soonest, number: float, body: Any, t: float, q: Vector, v: Vector, goal: Plan, m: Memory, p: Any
) -> Soonest:
    e = perceive(q, v, own_reading(v, goal, p), body, p)
    near = e.near > 0.5
    within = e.miss <= p.radius
    latched = (m[0] > 0.5) | within
    points_to = 1.0 if dot3(e.relative, e.right) >= 0.0 else -1.0
    at_first = points_to if m[1] == 0.0 else m[1]
    side, gate = whole(p.side), whole(p.gate)
    side = at_first if side == 2.0 else side
    h, xi = aside(e, side)
    demand = resolve(e, h, xi)
    acts = (gate == 0.0) | (gate > 2.0)
    acts = within if gate == 1.0 else acts
    acts = latched if gate == 2.0 else acts
    passed = 1.0 if (gate > 2.0) & (xi >= e.turn) else 0.0
    wait = e.wait + 0.5 * NEVER * passed  # an intruder in conflict takes precedence over one that is already clear
    sooner = acts & near & (wait < s.wait)
    return Soonest(
        wait if sooner else s.wait,
        demand[0] if sooner else s.x,
        demand[1] if sooner else s.y,
        demand[2] if sooner else s.z,
        passed if sooner else s.passed,
        side if sooner else s.side,
        1.0 if near else s.approached,
        1.0 if near & latched else s.latched,
        s.nan_guard + nan_guard(e, xi, p),
    )


@kernel
def steer(t: float, q: Vector, v: Vector, goal: Plan, s: Soonest, m: Memory, p: Any) -> tuple[Vector, Memory]:
    plan = planned(goal)
    acting = s.wait < NEVER
    now = acting & (s.passed < 0.5)
    hold = acting & (s.passed > 0.5) & (whole(p.gate) < 4.0) & (m[5] > 0.5)
    last = (s.x if now else m[2], s.y if now else m[3], s.z if now else m[4])
    flies = now | hold
    out = (
        (last[0] if flies else plan[0]) + s.nan_guard,
        (last[1] if flies else plan[1]) + s.nan_guard,
        (last[2] if flies else plan[2]) + s.nan_guard,
    )
    side = s.side if acting & (m[1] == 0.0) else m[1]
    latched = s.latched if s.approached > 0.5 else 0.0
    return out, (latched, side, last[0], last[1], last[2], 1.0 if now else m[5])


@kernel
def remember(p: Any) -> Memory:
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


component = Avoider(
    name="minimum_deviation_3d",
    title="Least deviation (decision making)",
    dimension=3,
    demand="velocity",
    parameters=MinimumDeviation,
    goal=Plan,
    memory=6,
    steer=steer,
    remember=remember,
    weigh=weigh,
    first=first,
    frame="ned",
)
