"""How components make one closed loop: vehicle, controller, avoider, obstacles, criterion. Templates with named slots.

Every name in capitals and every function set to `_slot` is a slot that `bind` fills; a component sees only its own
NamedTuple of parameters, taken from the flat vector p by constant slices. Start reading at `closed_loop`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

N_V = N_X = V0 = V1 = C0 = C1 = A0 = A1 = S0 = S1 = G0 = G1 = K0 = K1 = B0 = B1 = 0
DIMENSION = 2
NO_DEMAND: Any = (0.0, 0.0)
N_G = 0
INDEX = 0
E0 = E1 = 0
Given: Any = None
Vehicle: Any = None
Controller: Any = None
Avoider: Any = None
Start: Any = None
Goal: Any = None
Criterion: Any = None
Obstacle: Any = None


class Body(NamedTuple):
    """An obstacle in the plane as an avoider and a criterion see it: centre, velocity [m/s], radius [m]."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float


class Body3(NamedTuple):
    """An obstacle in space: centre, velocity [m/s], radius [m]."""

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    radius: float


def _slot(*_: Any) -> Any:
    raise NotImplementedError("a slot that bind did not fill")


begin = derivative = position = velocity = outside = pose = _slot
prepare = command = references = derive = _slot
steer = remember = _slot
body = before = bodies = demand = _slot
sample = samples = value = excluded = _slot


def as_given(p: Any) -> Any:
    """The parameters alone: no component derives anything."""
    return p


def with_derived(p: Any) -> Any:
    """The parameters as extended so far, and what one more component derives from its own."""
    return before(p) + derive(Given(*p[E0:E1]))


def no_bodies(t: float, p: tuple[float, ...]) -> tuple[Any, ...]:
    """No obstacle at all."""
    return ()


def first_body(t: float, p: tuple[float, ...]) -> tuple[Any, ...]:
    """One obstacle."""
    return (body(t, Obstacle(*p[B0:B1])),)


def more_bodies(t: float, p: tuple[float, ...]) -> tuple[Any, ...]:
    """The obstacles before, and one more."""
    return before(t, p) + (body(t, Obstacle(*p[B0:B1])),)  # type: ignore[no-any-return]  # noqa: RUF005


def first_sample(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The criterion's channels for the first obstacle."""
    return sample(t, q, v, x, u, around[0], p)


def more_samples(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channels for the obstacles before, and for one more."""
    return before(t, q, v, x, u, around, p) + sample(t, q, v, x, u, around[INDEX], p)


def asked(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Continuous guidance: the avoider is asked at every stage of the integrator."""
    return steer(t, q, v, Goal(*p[G0:G1]), around, g[DIMENSION:N_G], Avoider(*p[A0:A1]))[0]


def held(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Sampled guidance: the last demand holds until the next sample."""
    return g[0:DIMENSION]


def guide(t: float, x: Any, g: Any, p: Any) -> Any:
    """One guidance sample: demand and the avoider's memory."""
    xv = x[0:N_V]
    vp = Vehicle(*p[V0:V1])
    want, memory = steer(
        t, position(xv, vp), velocity(xv, vp), Goal(*p[G0:G1]), bodies(t, p), g[DIMENSION:N_G], Avoider(*p[A0:A1])
    )
    return want + memory


def blank(p: Any) -> Any:
    """Guidance before its first sample: no demand, the avoider's memory as it starts."""
    return NO_DEMAND + remember(Avoider(*p[A0:A1]))


def initial(p: Any) -> Any:
    """The state at the start: the vehicle's, then the controller's, which may depend on the first demand."""
    vp = Vehicle(*p[V0:V1])
    xv = begin(Start(*p[S0:S1]), vp)
    want = guide(0.0, xv, blank(p), p)[0:DIMENSION]
    return xv + prepare(xv, want, Controller(*p[C0:C1]))


def closed_loop(t: float, x: Any, g: Any, p: Any) -> Any:
    """Derivative of the whole state, and the criterion's channels, at one instant."""
    xv = x[0:N_V]
    vp = Vehicle(*p[V0:V1])
    q = position(xv, vp)
    v = velocity(xv, vp)
    around = bodies(t, p)
    want = demand(t, q, v, around, g, p)
    u, dxc = command(t, xv, x[N_V:N_X], want, Controller(*p[C0:C1]))
    dxv = derivative(t, xv, u, vp)
    return dxv + dxc, samples(t, q, v, xv, u, around, Criterion(*p[K0:K1]))


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
    """What a trace shows at one instant: pose (6), command, references, channels, centres of the obstacles."""
    xv = x[0:N_V]
    vp = Vehicle(*p[V0:V1])
    q = position(xv, vp)
    v = velocity(xv, vp)
    around = bodies(t, p)
    want = demand(t, q, v, around, g, p)
    cp = Controller(*p[C0:C1])
    u, _ = command(t, xv, x[N_V:N_X], want, cp)
    return pose(xv, vp) + u + references(xv, want, cp) + samples(t, q, v, xv, u, around, Criterion(*p[K0:K1]))
