"""How components make one closed loop: vehicle, controller, avoider, obstacles, faults, environment, criterion.

Templates with named slots: every name in capitals and every function set to `_slot` is one, and `bind` fills it. A
component sees only its own NamedTuple of parameters, taken from the flat vector p by constant slices. Components of
which there may be several form chains, made of `links`. Start reading at `closed_loop`.
"""

from __future__ import annotations

from typing import Any

N_V = N_X = 0
V0 = V1 = C0 = C1 = A0 = A1 = S0 = S1 = G0 = G1 = K0 = K1 = Y0 = Y1 = 0
XC0 = XC1 = XA0 = XA1 = XE0 = XE1 = XO0 = XO1 = 0
DIMENSION = 2
M1 = 0
NO_DEMAND: Any = (0.0, 0.0)
NOTHING_KEPT: Any = ()
Vehicle: Any = None
Controller: Any = None
Avoider: Any = None
Start: Any = None
Goal: Any = None
Criterion: Any = None


def _slot(*_: Any) -> Any:
    raise NotImplementedError("a slot that bind did not fill")


begin = derivative = position = velocity = outside = pose = measured = settle = felt = _slot
prepare = command = references = on_sample = on_use = demand = kept = _slot
steer = remember = _slot
bodies = perceived = readings = centres = moved = woken_obstacles = _slot
errors = actuated = rested = surroundings = woken_environment = _slot
value = excluded = _slot


def as_measured(x: Any, env: Any, p: Any) -> Any:
    """The controller knows the vehicle as navigation reports it."""
    return x


def aware(t: float, x: Any, p: Any) -> Any:
    """What the vehicle takes for the truth: its state, position, velocity, and the obstacles it sees."""
    vp = Vehicle(*p[V0:V1])
    xm = measured(x[0:N_V], errors(t, p), vp)
    q = position(xm, vp)
    v = velocity(xm, vp)
    return xm, q, v, perceived(t, x[XO0:XO1], pose(xm, vp), q, v, p)


def guide(t: float, x: Any, g: Any, p: Any) -> Any:
    """One guidance sample: demand and the avoider's memory."""
    xm, q, v, seen = aware(t, x, p)
    want, memory = steer(t, q, v, Goal(*p[G0:G1]), seen, g[DIMENSION:M1], Avoider(*p[A0:A1]))
    return on_sample(xm, want, p) + memory + kept(t, want, g)


def asked_at(t: float, x: Any, g: Any, place: Any, p: Any) -> Any:
    """What the avoider would ask for if the vehicle took itself to be at that place, all else being as it is.

    Its velocity and attitude, the obstacles and the avoider's memory stay: no flight asks this, a picture of it does.
    """
    vp = Vehicle(*p[V0:V1])
    xm = measured(x[0:N_V], errors(t, p), vp)
    v = velocity(xm, vp)
    seen = perceived(t, x[XO0:XO1], pose(xm, vp), place, v, p)
    return steer(t, place, v, Goal(*p[G0:G1]), seen, g[DIMENSION:M1], Avoider(*p[A0:A1]))[0]


def blank(p: Any) -> Any:
    """Guidance before its first sample: no demand, the avoider's memory as it starts."""
    return NO_DEMAND + remember(Avoider(*p[A0:A1])) + NOTHING_KEPT


def initial(p: Any) -> Any:
    """The state at the start: vehicle, controller, actuators, environment, obstacles, in this order."""
    vp = Vehicle(*p[V0:V1])
    cp = Controller(*p[C0:C1])
    xv = begin(Start(*p[S0:S1]), vp)
    xo = woken_obstacles(p)
    xm = measured(xv, errors(0.0, p), vp)
    q = position(xm, vp)
    v = velocity(xm, vp)
    seen = perceived(0.0, xo, pose(xm, vp), q, v, p)
    want = steer(0.0, q, v, Goal(*p[G0:G1]), seen, blank(p)[DIMENSION:M1], Avoider(*p[A0:A1]))[0]
    xe = woken_environment(p)
    env, _ = surroundings(0.0, position(xv, vp), velocity(xv, vp), xe, p)
    xm = felt(xm, env, vp)
    want = on_use(xm, on_sample(xm, want, p), p)
    xc = prepare(xm, want, cp)
    u, _ = command(0.0, xm, xc, want, cp)
    return xv + xc + rested(u, p) + xe + xo


def closed_loop(t: float, x: Any, g: Any, p: Any) -> Any:
    """Derivative of the whole state, and the criteria's channels, at one instant."""
    vp = Vehicle(*p[V0:V1])
    xm, q, v, seen = aware(t, x, p)
    want = demand(t, q, v, seen, g, p)
    xv = x[0:N_V]
    q = position(xv, vp)
    v = velocity(xv, vp)
    env, dxe = surroundings(t, q, v, x[XE0:XE1], p)
    xm = felt(xm, env, vp)
    u, dxc = command(t, xm, x[XC0:XC1], on_use(xm, want, p), Controller(*p[C0:C1]))
    u, dxa = actuated(t, u, x[XA0:XA1], p)
    dxv = derivative(t, xv, u, env, vp)
    dxo = moved(t, x[XO0:XO1], q, v, p)
    around = bodies(t, x[XO0:XO1], q, p)
    return dxv + dxc + dxa + dxe + dxo, readings(t, q, v, xv, u, around, p)


def settled(x: Any, p: Any) -> Any:
    """The state after a step, held within the vehicle's own stops."""
    return settle(x[0:N_V], Vehicle(*p[V0:V1])) + x[N_V:N_X]


def envelope(x: Any, p: Any) -> float:
    """0 inside the vehicle's envelope, else the number of the limit that is exceeded (1 is its first)."""
    return outside(x[0:N_V], Vehicle(*p[V0:V1]))  # type: ignore[no-any-return]


def cost(lowest: Any, p: Any) -> float:
    """The value of the criterion that decides, from the lowest value of every channel."""
    return value(lowest[Y0:Y1], Criterion(*p[K0:K1]))  # type: ignore[no-any-return]


def barred(first: Any, p: Any) -> bool:
    """Whether the scenario's precondition fails: the first reading of the channels excludes the flight."""
    return excluded(first[Y0:Y1], Criterion(*p[K0:K1]))  # type: ignore[no-any-return]


def observation(t: float, x: Any, g: Any, p: Any) -> Any:
    """What a trace shows at one instant: pose (6), inputs, references, the obstacles' centres (3 each), channels."""
    vp = Vehicle(*p[V0:V1])
    cp = Controller(*p[C0:C1])
    xm, q, v, seen = aware(t, x, p)
    want = demand(t, q, v, seen, g, p)
    xv = x[0:N_V]
    q = position(xv, vp)
    v = velocity(xv, vp)
    env, _ = surroundings(t, q, v, x[XE0:XE1], p)
    xm = felt(xm, env, vp)
    want = on_use(xm, want, p)
    u, _ = command(t, xm, x[XC0:XC1], want, cp)
    u, _ = actuated(t, u, x[XA0:XA1], p)
    around = bodies(t, x[XO0:XO1], q, p)
    seen_channels = readings(t, q, v, xv, u, around, p)
    return pose(xv, vp) + u + references(xm, want, cp) + centres(around) + seen_channels
