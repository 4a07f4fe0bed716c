"""How components make one closed loop: vehicle, controller, avoider, obstacles, faults, environment, criterion.

Templates with named slots: every name in capitals and every function set to `_slot` is one, and `bind` fills it. A
component sees only its own NamedTuple of parameters, taken from the flat vector p by constant slices. Components of
which there may be several form chains: each link calls the one `before`. Start reading at `closed_loop`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from worker.kernels.maths import clip, kernel

N_V = N_X = N_G = N_U = 0
V0 = V1 = C0 = C1 = A0 = A1 = S0 = S1 = G0 = G1 = K0 = K1 = 0
XC0 = XC1 = XA0 = XA1 = XE0 = XE1 = XO0 = XO1 = 0
T0 = T1 = P0 = P1 = X0 = X1 = E0 = E1 = INDEX = NEXT = 0
DIMENSION = 2
M1 = M2 = 0
NO_DEMAND: Any = (0.0, 0.0)
NOTHING_KEPT: Any = ()
Given: Any = None
Trimmed: Any = None
Vehicle: Any = None
Controller: Any = None
Avoider: Any = None
Start: Any = None
Goal: Any = None
Criterion: Any = None
Own: Any = None
"""The parameters of the component that a link of a chain adds."""


class Body(NamedTuple):
    """An obstacle in the plane as an avoider and a criterion see it from where they are.

    Centre [m], velocity [m/s], radius [m]; distance to its surface [m], negative inside, and the unit normal there,
    pointing away from it.
    """

    x: float
    y: float
    vx: float
    vy: float
    radius: float
    gap: float
    nx: float
    ny: float


class Body3(NamedTuple):
    """An obstacle in space, as `Body`."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    radius: float
    gap: float
    nx: float
    ny: float
    nz: float


class Sight(NamedTuple):
    """What perception adds to an obstacle: displacement [m], change of velocity [m/s]; visible is 1, or 0."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    visible: float


class Seen(NamedTuple):
    """When obstacles are seen: the instant [s], and for how long the tracker has carried them on from there [s]."""

    at: float
    ahead: float


class Surroundings(NamedTuple):
    """What the environment does to a vehicle: wind in the world frame [m/s], slope of the ground (rise per metre).

    rolling: resistance of the ground, as a share of the weight.
    """

    wind_x: float
    wind_y: float
    wind_z: float
    slope_x: float
    slope_y: float
    rolling: float = 0.0


class Errors(NamedTuple):
    """What navigation adds to the truth: position [m], heading [rad], speed [m/s]."""

    x: float
    y: float
    z: float
    heading: float
    speed: float


def _slot(*_: Any) -> Any:
    raise NotImplementedError("a slot that bind did not fill")


begin = derivative = position = velocity = outside = pose = measured = settle = felt = _slot
prepare = command = references = derive = balance = translate = on_sample = on_use = _slot
steer = remember = kept = wait = late_by = blended = weigh = weighed = first = decide = _slot
body = move = wake = before = demand = _slot
bodies = perceived = sight = shifted = shown = samples = centre = centres = actuated = surroundings = errors = (
    seen_at
) = moved = carried = solid = point = _slot
woken_obstacles = woken_environment = rested = _slot
rest = act = blow = mistake = delay = see = _slot
sample = value = excluded = _slot


def as_given(p: Any) -> Any:
    """The parameters alone: no component derives anything."""
    return p


def no_balance(p: Any) -> tuple[()]:
    """The vehicle has no trim."""
    return ()


def balanced(p: Any) -> Any:
    """The vehicle's trim at the nominal values."""
    return Trimmed(*p[T0:T1])


def with_derived(p: Any) -> Any:
    """The parameters as extended so far, and what one more component derives from its own."""
    return before(p) + derive(Given(*p[E0:E1]), balance(p))


# Chains. `x` is the part of the state that belongs to the chain, of which a link takes x[X0:X1].


def nothing(*_: Any) -> tuple[()]:
    """The start of a chain that gives a tuple."""
    return ()


def more_bodies(t: float, x: Any, q: Any, p: Any) -> Any:
    """The obstacles before as they are, seen from q, and one more."""
    return before(t, x, q, p) + (body(t, x[X0:X1], q, Own(*p[P0:P1])),)


def first_body(t: float, x: Any, q: Any, p: Any) -> Any:
    """One obstacle as it is, seen from q."""
    return (body(t, x[X0:X1], q, Own(*p[P0:P1])),)


def first_seen(t: float, x: Any, own: Any, q: Any, v: Any, p: Any) -> Any:
    """The first obstacle as the avoider perceives it."""
    when = seen_at(t, p)
    there = body(when.at, x[X0:X1], q, Own(*p[P0:P1]))
    error = carried(t, when, there, sight(t, 0.0, point(q) + own[3:6], point(v), solid(there), p), p)
    return (shown(body(when.at, x[X0:X1], shifted(q, error), Own(*p[P0:P1])), error, q),)


def more_seen(t: float, x: Any, own: Any, q: Any, v: Any, p: Any) -> Any:
    """The obstacles perceived before, and one more."""
    when = seen_at(t, p)
    there = body(when.at, x[X0:X1], q, Own(*p[P0:P1]))
    error = carried(t, when, there, sight(t, float(INDEX), point(q) + own[3:6], point(v), solid(there), p), p)
    return before(t, x, own, q, v, p) + (shown(body(when.at, x[X0:X1], shifted(q, error), Own(*p[P0:P1])), error, q),)


def at_once(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """No fault of timing: obstacles are seen as they are now."""
    return error


def carried_on(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """An obstacle whose motion is known in time, seen as it was and carried on along its velocity then."""
    b = solid(there)
    return moved_by(error, when.ahead, b.vx, b.vy, b.vz)


def carried_back(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """An obstacle with states of its own: its past is not kept, so it is taken back along its velocity now."""
    past = before(t, p)
    b = solid(there)
    return moved_by(error, past.ahead - (t - past.at), b.vx, b.vy, b.vz)


@kernel
def moved_by(error: Sight, time: float, vx: float, vy: float, vz: float) -> Sight:
    """A displacement, and more along a velocity for a time."""
    return Sight(
        error.x + time * vx, error.y + time * vy, error.z + time * vz, error.vx, error.vy, error.vz, error.visible
    )


def point2(q: Any) -> tuple[float, float, float]:
    """A plane vector in space."""
    return q[0], q[1], 0.0


def point3(q: Any) -> tuple[float, float, float]:
    """A vector in space as it is."""
    return q  # type: ignore[no-any-return]


def solid2(b: Any) -> Body3:
    """An obstacle in the plane as one in space."""
    return Body3(b.x, b.y, 0.0, b.vx, b.vy, 0.0, b.radius, b.gap, b.nx, b.ny, 0.0)


def solid3(b: Any) -> Body3:
    """An obstacle in space as it is."""
    return b  # type: ignore[no-any-return]


def first_centre(around: Any) -> Any:
    """The first obstacle's centre."""
    return centre(around[0])


def more_centres(around: Any) -> Any:
    """The centres of the obstacles before, and of one more."""
    return before(around) + centre(around[INDEX])


def centre2(b: Any) -> tuple[float, float, float]:
    """The centre of an obstacle in the plane."""
    return b.x, b.y, 0.0


def centre3(b: Any) -> tuple[float, float, float]:
    """The centre of an obstacle in space."""
    return b.x, b.y, b.z


def clear_sight(t: float, index: float, own: Any, v: Any, there: Any, p: Any) -> Sight:
    """Perception without error."""
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def less_sight(t: float, index: float, own: Any, v: Any, there: Any, p: Any) -> Sight:
    """The errors of perception before, and of one more fault."""
    a = before(t, index, own, v, there, p)
    b = see(t, index, own, v, there, Own(*p[P0:P1]))
    return Sight(a.x + b.x, a.y + b.y, a.z + b.z, a.vx + b.vx, a.vy + b.vy, a.vz + b.vz, a.visible * b.visible)


FAR = 1e7
"""Where an obstacle that is not seen is shown: beyond the reach of any avoider [m]."""


def shifted2(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in the plane looks as it does."""
    return q[0] - error.x, q[1] - error.y


def shifted3(q: Any, error: Sight) -> Any:
    """From where a displaced obstacle in space looks as it does."""
    return q[0] - error.x, q[1] - error.y, q[2] - error.z


def shown2(b: Any, error: Sight, q: Any) -> Body:
    """An obstacle in the plane as perceived: displaced, or far away when it is not seen."""
    seen = error.visible > 0.5
    return Body(
        b.x + error.x if seen else q[0] + FAR,
        b.y + error.y if seen else q[1],
        b.vx + error.vx if seen else 0.0,
        b.vy + error.vy if seen else 0.0,
        b.radius,
        b.gap if seen else FAR,
        b.nx,
        b.ny,
    )


def shown3(b: Any, error: Sight, q: Any) -> Body3:
    """An obstacle in space as perceived: displaced, or far away when it is not seen."""
    seen = error.visible > 0.5
    return Body3(
        b.x + error.x if seen else q[0] + FAR,
        b.y + error.y if seen else q[1],
        b.z + error.z if seen else q[2],
        b.vx + error.vx if seen else 0.0,
        b.vy + error.vy if seen else 0.0,
        b.vz + error.vz if seen else 0.0,
        b.radius,
        b.gap if seen else FAR,
        b.nx,
        b.ny,
        b.nz,
    )


def no_move(t: float, x: Any, q: Any, v: Any, p: Any) -> tuple[()]:
    """No obstacle has a state of its own."""
    return ()


def more_moves(t: float, x: Any, q: Any, v: Any, p: Any) -> Any:
    """The derivatives of the obstacles' states before, and of one more."""
    return before(t, x, q, v, p) + move(t, x[X0:X1], q, v, Own(*p[P0:P1]))


def no_wake(p: Any) -> tuple[()]:
    """No states at the start."""
    return ()


def more_wakes(p: Any) -> Any:
    """The states of a chain at the start before, and of one more component."""
    return before(p) + wake(Own(*p[P0:P1]))


def first_sample(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The criterion's channels for the first obstacle."""
    return sample(t, q, v, x, u, around[0], p)


def more_samples(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channels for the obstacles before, and for one more."""
    return before(t, q, v, x, u, around, p) + sample(t, q, v, x, u, around[INDEX], p)


def now(t: float, p: Any) -> Seen:
    """Obstacles are seen where they are at this instant."""
    return Seen(t, 0.0)


def then(t: float, p: Any) -> Seen:
    """When obstacles are seen, through the faults before and one more on what those let through."""
    first = before(t, p)
    last = delay(first.at, Own(*p[P0:P1]))
    return Seen(last.at, first.ahead + last.ahead)


def no_error(t: float, p: Any) -> Errors:
    """Navigation without error."""
    return Errors(0.0, 0.0, 0.0, 0.0, 0.0)


def more_error(t: float, p: Any) -> Errors:
    """The errors of navigation before, and of one more fault."""
    a = before(t, p)
    b = mistake(t, Own(*p[P0:P1]))
    return Errors(a.x + b.x, a.y + b.y, a.z + b.z, a.heading + b.heading, a.speed + b.speed)


def as_commanded(t: float, u: Any, x: Any, p: Any) -> Any:
    """Actuators that do what they are told."""
    return u, ()


def more_actuated(t: float, u: Any, x: Any, p: Any) -> Any:
    """The inputs behind the faults before, and one more fault on the input INDEX."""
    u, dx = before(t, u, x, p)
    changed, change = act(t, u[INDEX], x[X0:X1], Own(*p[P0:P1]))
    return u[0:INDEX] + (changed,) + u[NEXT:N_U], dx + change


def more_rests(u: Any, p: Any) -> Any:
    """The states of the actuators before at the start, and of one more, given the first command."""
    return before(u, p) + rest(u[INDEX], Own(*p[P0:P1]))


def no_rest(u: Any, p: Any) -> tuple[()]:
    """No actuator has a state of its own."""
    return ()


def still(t: float, q: Any, v: Any, x: Any, p: Any) -> Any:
    """No wind, level ground."""
    return Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), ()


def more_surroundings(t: float, q: Any, v: Any, x: Any, p: Any) -> Any:
    """What the environment does before, and one more part of it."""
    a, dx = before(t, q, v, x, p)
    b, change = blow(t, point(q), point(v), x[X0:X1], Own(*p[P0:P1]))
    total = Surroundings(
        a.wind_x + b.wind_x,
        a.wind_y + b.wind_y,
        a.wind_z + b.wind_z,
        a.slope_x + b.slope_x,
        a.slope_y + b.slope_y,
        a.rolling + b.rolling,
    )
    return total, dx + change


# The loop itself.


def as_measured(x: Any, env: Any, p: Any) -> Any:
    """The controller knows the vehicle as navigation reports it."""
    return x


def steered(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """The demand of an avoider that weighs the obstacles one after another."""
    return decide(t, q, v, goal, weighed(t, q, v, goal, around, m, p), m, p)


def unweighed(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """What an avoider begins with before the first obstacle."""
    return first(t, q, v, goal, m, p)


def more_weighed(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """The obstacles weighed before, and one more."""
    return weigh(before(t, q, v, goal, around, m, p), float(INDEX), around[INDEX], t, q, v, goal, m, p)


def as_demanded(x: Any, want: Any, p: Any) -> Any:
    """A demand that stays as it is."""
    return want


def translated(x: Any, want: Any, p: Any) -> Any:
    """What the controller makes of a demand."""
    return translate(x, want, Controller(*p[C0:C1]))


def asked(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Continuous guidance: the avoider is asked at every stage of the integrator."""
    return steer(t, q, v, Goal(*p[G0:G1]), around, g[DIMENSION:M1], Avoider(*p[A0:A1]))[0]


def held(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Sampled guidance: the last demand holds until the next sample."""
    return g[0:DIMENSION]


KEPT = 4
"""How many earlier demands are kept for guidance that comes late: the most periods by which it can."""


def waited(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Sampled guidance that comes late: the demand of earlier samples, interpolated between two of them."""
    late = clip(late_by(p), 0.0, float(KEPT))
    return blended(late, g[0:DIMENSION], g[M1:N_G])


@kernel
def share(late: float, samples: float) -> float:
    """The weight of the demand of so many samples ago: linear interpolation in time."""
    weight = 1.0 - abs(late - samples)
    return 0.0 if weight < 0.0 else weight


def blended2(late: float, new: Any, old: Any) -> tuple[float, float]:
    """The demand in the plane as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[2] + d * old[4] + e * old[6],
        a * new[1] + b * old[1] + c * old[3] + d * old[5] + e * old[7],
    )


def blended3(late: float, new: Any, old: Any) -> tuple[float, float, float]:
    """The demand in space as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[3] + d * old[6] + e * old[9],
        a * new[1] + b * old[1] + c * old[4] + d * old[7] + e * old[10],
        a * new[2] + b * old[2] + c * old[5] + d * old[8] + e * old[11],
    )


def in_time(p: Any) -> float:
    """Guidance takes no time."""
    return 0.0


def later(p: Any) -> float:
    """By how many periods guidance is late, through the faults before and one more."""
    return before(p) + wait(Own(*p[P0:P1]))  # type: ignore[no-any-return]


def none_kept(t: float, want: Any, g: Any) -> tuple[()]:
    """No earlier demand is needed."""
    return ()


def four_kept(t: float, want: Any, g: Any) -> Any:
    """The last demands, latest first; at the start the first one counts as all that were before it."""
    if t > 0.0:
        return g[0:DIMENSION] + g[M1:M2]
    return want + want + want + want


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
    """Derivative of the whole state, and the criterion's channels, at one instant."""
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
    return dxv + dxc + dxa + dxe + dxo, samples(t, q, v, xv, u, around, Criterion(*p[K0:K1]))


def settled(x: Any, p: Any) -> Any:
    """The state after a step, held within the vehicle's own stops."""
    return settle(x[0:N_V], Vehicle(*p[V0:V1])) + x[N_V:N_X]


def envelope(x: Any, p: Any) -> float:
    """0 inside the vehicle's envelope, else the number of the limit that is exceeded (1 is its first)."""
    return outside(x[0:N_V], Vehicle(*p[V0:V1]))  # type: ignore[no-any-return]


def cost(lowest: Any, p: Any) -> float:
    """The criterion's value from the lowest value of every channel."""
    return value(lowest, Criterion(*p[K0:K1]))  # type: ignore[no-any-return]


def barred(first: Any, p: Any) -> bool:
    """Whether the scenario's precondition fails: the first reading of the channels excludes the flight."""
    return excluded(first, Criterion(*p[K0:K1]))  # type: ignore[no-any-return]


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
    seen_channels = samples(t, q, v, xv, u, around, Criterion(*p[K0:K1]))
    return pose(xv, vp) + u + references(xm, want, cp) + centres(around) + seen_channels
