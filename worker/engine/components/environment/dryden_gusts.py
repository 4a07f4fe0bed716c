"""Dryden gusts: continuous random turbulence of the low atmosphere, along, across and vertically to the flight.

    Phi_u(w) = s_h^2 2 T_h/pi / (1 + (T_h w)^2)
    Phi_v(w) = s_h^2 T_h/pi (1 + 3 (T_h w)^2) / (1 + (T_h w)^2)^2        and Phi_w with s_w, T_w
    s_w = 0.1 W,  s_h = s_w / (0.177 + 0.000823 h)^0.4,  L_w = h,  L_h = h / (0.177 + 0.000823 h)^1.2,  T = L / V

Phi is the one-sided spectrum over the circular frequency w (its integral is the variance), s the deviation [m/s],
L the length [ft], T the time scale [s]; h the height above ground [ft], W the wind at 20 ft, V the airspeed. Forming
filters as states, driven by white noise, with n held for `period` and of unit intensity:

    dg_u/dt = (s_h sqrt(2 T_h) n_u - g_u) / T_h
    da/dt = (s_h sqrt(T_h) n_v - a) / T_h,  db/dt = (a - b) / T_h,  g_v = sqrt(3) a + (1 - sqrt(3)) b;  g_w the same

With n held, the deviation of g is s sqrt(tanh(x) / x) at its ends and less in between, x = period / (2 T) (g_u). A
period above 0.1 h / V is refused: up to there it is at least 0.963 s at any time, and 0.975 s on average.
They start in their stationary state, so the statistics are the same from the first second on; on aircraft, which start
trimmed in still air, the first gust acts as a step. n comes from a hash of
(seed, axis, number of the sample). Height and airspeed are constants of the flight, not the vehicle's present ones.
u is along the vehicle's horizontal velocity over ground, v to the side of the y axis from there, w along z; MIL-F-8785C
takes the horizontal airspeed instead. Turbulent rotation (p, q, r) is ignored. W = 7.7, 15.4 and 23.2 m/s (15, 30,
45 kn) are light, moderate and severe. It has no effect on ground robots.
Source: MIL-F-8785C, section 3.7 (Dryden form; low-altitude model, 10 ft to 1000 ft).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Derived, Environment, Order, Parameter
from worker.engine.kernels.maths import kernel, norm2, normals, sample_number
from worker.engine.kernels.views import Surroundings
from worker.engine.physics import instants


class DrydenGusts(NamedTuple):
    W: Annotated[float, Parameter("m/s", "Wind at 6 m above ground", 0.0, 60.0)] = 0.0
    h: Annotated[float, Parameter("m", "Height above ground", 3.048, 304.8)] = 50.0
    V: Annotated[float, Parameter("m/s", "Airspeed", 0.1, 500.0)] = 15.0
    period: Annotated[float, Parameter("s", "Hold period of the driving noise", 1e-3, 10.0)] = 0.1
    seed: Annotated[float, Parameter("", "Which realisation", 0.0, 16777215.0)] = 0.0


class Constants(NamedTuple):
    per_h: float
    per_w: float
    drive_u: float
    drive_v: float
    drive_w: float
    s_h: float
    s_w: float
    period: float
    seed: float


FOOT = 0.3048
SHORT = 0.1
"""The longest period, as a fraction of the shorter time scale, h / V."""
ROOT_3 = 1.7320508075688772
State = tuple[float, float, float, float, float]


@kernel
def derive(p: DrydenGusts, trim: object) -> tuple[float, ...]:
    h = p.h / FOOT
    shape = 0.177 + 0.000823 * h
    s_w = 0.1 * p.W
    s_h = s_w / shape**0.4
    per_h = p.V / (FOOT * h / shape**1.2)
    per_w = p.V / (FOOT * h)
    # dx/dt = (s sqrt(T) n / sqrt(period) - x) / T
    drive = s_h * (per_h / p.period) ** 0.5
    return (
        per_h, per_w, drive * 2.0**0.5, drive, s_w * (per_w / p.period) ** 0.5, s_h, s_w, p.period, p.seed,
    )  # fmt: skip


@kernel
def wake(p: Constants) -> State:
    u, v = normals(p.seed, 0.0, -1.0)
    w, a = normals(p.seed, 1.0, -1.0)
    b, _ = normals(p.seed, 2.0, -1.0)
    # Stationary: var a = s^2/2, cov(a, b) = var b = s^2/4
    return (
        p.s_h * u,
        p.s_h * 0.7071067811865476 * v,
        p.s_h * (0.3535533905932738 * v + 0.3535533905932738 * a),
        p.s_w * 0.7071067811865476 * w,
        p.s_w * (0.3535533905932738 * w + 0.3535533905932738 * b),
    )


@kernel
def draw(t: float, p: Constants) -> tuple[float, float, float]:
    k = sample_number(t, p.period)
    n_u, n_v = normals(p.seed, 0.0, k)
    n_w, _ = normals(p.seed, 1.0, k)
    return n_u, n_v, n_w


@kernel
def blow(t: float, q: Any, v: Any, e: State, n: Any, p: Constants) -> tuple[Surroundings, State]:
    n_u, n_v, n_w = n
    g_u, a_v, b_v, a_w, b_w = e
    g_v = ROOT_3 * a_v + (1.0 - ROOT_3) * b_v
    g_w = ROOT_3 * a_w + (1.0 - ROOT_3) * b_w
    per_speed = 1.0 / (norm2(v[0], v[1]) + 1e-9)
    x = v[0] * per_speed
    y = v[1] * per_speed
    return Surroundings(x * g_u - y * g_v, y * g_u + x * g_v, g_w, 0.0, 0.0, 0.0), (
        p.drive_u * n_u - p.per_h * g_u,
        p.drive_v * n_v - p.per_h * a_v,
        p.per_h * (a_v - b_v),
        p.drive_w * n_w - p.per_w * a_w,
        p.per_w * (a_w - b_w),
    )


component = Environment(
    name="dryden_gusts",
    title="Dryden gusts",
    parameters=DrydenGusts,
    blow=blow,
    states=5,
    wake=wake,
    derived=Derived(Constants, derive),
    orders=(Order(("V", "period"), ("h",), "noise that is held longer weakens the gusts; shorten the period", SHORT),),
    switches=instants.samples,
    draw=draw,
    draws=3,
)
