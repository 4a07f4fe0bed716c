"""Decision-making avoidance of intruders by the smallest change of velocity, in space.

    V_AB = V_A - V_B,   d_AB = |r| sin(angle of V_AB and r)                           (7.1)
    conflict: d_AB <= R_p while the range closes                                      (7.2)
    V_d = |V_AB| cos(eta - xi) [cos(eta) r^ + sin(eta) h^] + V_B                      (7.7)

r: from the own position to the intruder; xi: angle of V_AB from r towards h^; eta = asin(R_p / |r|), at most eta_max;
h^: unit vector across r to the side taken. Without a conflict the planned velocity is flown. Of several conflicts the
one with the soonest closest approach is resolved.

side   -1 left, 1 right of the line of sight in the horizontal, committed; 0 free: whither V_AB points already (7.7);
       2 the side it points to at the first sample of a conflict, committed for the flight
gate   0 acts on every intruder that comes closer within range; 1 while d_AB <= R_p; 2 from the first d_AB <= R_p on,
       until nothing comes closer; 3 while xi < eta, then holds the last demand; 4 while xi < eta, else as planned

V_A and V_B are read with errors: own speed + du at the track + dpsi, the intruder's speed + du0 at its track turned by
dpsi0, anticlockwise seen from above. V_A is the planned velocity, unless `instant` is 1. Range and its rate are exact.
Source: Srikanthakumar, section 7.2; equation 7.7 is 0/0 at xi = 0, the form above equals it elsewhere. Reconstructed:
R_p (planning) apart from the radius to be kept, range, eta_max, side, gate, "readings at the nominal case" as the
planned velocity, and the sense of dpsi0. Meant for guidance sampled at its own period. Axes with z down.
Limits: pairwise; velocities are taken as constant; envelope and dynamics of the aircraft are left to its autopilot.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.kernels.component import Avoider, Parameter, extended
from worker.kernels.maths import kernel
from worker.kernels.resolution import NEVER, Plan, Sensing, aside, own_reading, perceive, planned, resolve
from worker.kernels.space import Vector, dot3


class Choice(NamedTuple):
    side: Annotated[float, Parameter("", "Side taken: -1 left, 1 right, 0 free, 2 as at first", -1.0, 2.0)] = -1.0
    gate: Annotated[float, Parameter("", "When it acts: 0 to 4, see above", 0.0, 4.0)] = 4.0


MinimumDeviation = extended("MinimumDeviation", Sensing, Choice)
Memory = tuple[float, float, float, float, float, float]
"""Latched, side committed to (0: none yet), last demand (3) [m/s], whether there is one."""


@kernel
def steer(t: float, q: Vector, v: Vector, goal: Plan, bodies: Any, memory: Memory, p: Any) -> tuple[Vector, Memory]:
    plan = planned(goal)
    own = own_reading(v, goal, p)
    side = memory[1] if p.side > 1.5 else p.side
    soonest, ax, ay, az, clear, wanted = NEVER, plan[0], plan[1], plan[2], 0.0, 0.0
    approached, inside = 0.0, memory[0]
    for body in bodies:
        e = perceive(q, v, own, body, p)
        within = e.miss <= p.radius
        approached = 1.0 if e.near > 0.5 else approached
        latched = 1.0 if within else memory[0]
        inside = latched if (e.near > 0.5) & (latched > inside) else inside
        first = 1.0 if dot3(e.relative, e.right) >= 0.0 else -1.0
        turned_to = first if (p.side > 1.5) & (side == 0.0) else side
        h, xi = aside(e, turned_to)
        demand = resolve(e, h, xi)
        acts = (p.gate < 0.5) | (p.gate > 2.5)
        acts = within if (p.gate > 0.5) & (p.gate < 1.5) else acts
        acts = latched > 0.5 if (p.gate > 1.5) & (p.gate < 2.5) else acts
        passed = 1.0 if (p.gate > 2.5) & (xi >= e.turn) else 0.0
        # one in conflict goes before one that is already passed clear
        when = e.wait + 0.5 * NEVER * passed
        sooner = acts & (e.near > 0.5) & (when < soonest)
        soonest = when if sooner else soonest
        ax = demand[0] if sooner else ax
        ay = demand[1] if sooner else ay
        az = demand[2] if sooner else az
        clear = passed if sooner else clear
        wanted = turned_to if sooner else wanted
    acting = soonest < NEVER
    now = acting & (clear < 0.5)
    hold = acting & (clear > 0.5) & (p.gate < 3.5) & (memory[5] > 0.5)
    kept = (memory[2] if hold else plan[0], memory[3] if hold else plan[1], memory[4] if hold else plan[2])
    out = (ax if now else kept[0], ay if now else kept[1], az if now else kept[2])
    last = (ax if now else memory[2], ay if now else memory[3], az if now else memory[4])
    committed = wanted if acting & (memory[1] == 0.0) else memory[1]
    latch = inside if approached > 0.5 else 0.0
    return out, (latch, committed, last[0], last[1], last[2], 1.0 if now else memory[5])


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
)
