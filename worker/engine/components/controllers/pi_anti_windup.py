"""PI control of a Pioneer's speed and turn rate with anti-windup, following a demanded force or velocity.

    e_u = u_d - u                      u_ref     = K_1 e_u + K_3 int(e_u)
    e_w = omega_d - omega              omega_ref = K_2 e_w + K_4 int(e_w)

    u_d     = k_p (D . heading)
    omega_d = k_q / (a^2 + 1) (a D . left + angle(D, heading))

D is the demanded force or velocity; a velocity is followed directly, with k_p = 1. u_d is limited to
[u_low, u_high], omega_d to [-w_high, w_high]. angle is wrapped to (-pi, pi], and 0 where D is 0.
Anti-windup: while a speed is at its stop and the robot would accelerate beyond it, the integral is
int(e - k_aw A), A the acceleration removed by the stop. The controller does not measure A: it computes A from the
*nominal* robot's model (3.18, 3.19) and its own output, so A is known up to the uncertainty of the parameters.
About trim, both references held, the loop is quadratic in u, omega and both integrals between the stops.
Source: Srikanthakumar, equations 3.22 (PI), 3.25 to 3.27 and 3.37. Reconstructed: all gains (they are not given),
the wrapped angle, the form of the anti-windup (only named there). The reference speeds have no limits of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import (
    AboutTrim,
    Controller,
    Derived,
    NoTrim,
    Order,
    Parameter,
    Polynomial,
    Signal,
    Trimmed,
)
from worker.engine.kernels.maths import atan2, clip, kernel, sincos


class PiAntiWindup(NamedTuple):
    k_p: Annotated[float, Parameter("m/(s N)", "Speed demanded per force", 0.0, 1e3)] = 0.76
    k_q: Annotated[float, Parameter("1/s", "Turn rate demanded per heading error", 0.0, 1e3)] = 4.0
    K_1: Annotated[float, Parameter("", "Speed loop, proportional gain", 0.0, 1e4)] = 2.2
    K_2: Annotated[float, Parameter("", "Turn loop, proportional gain", 0.0, 1e4)] = 1.3
    K_3: Annotated[float, Parameter("1/s", "Speed loop, integral gain", 0.0, 1e4)] = 0.41
    K_4: Annotated[float, Parameter("1/s", "Turn loop, integral gain", 0.0, 1e4)] = 0.057
    k_aw: Annotated[float, Parameter("s", "Anti-windup, per acceleration removed", 0.0, 1e3)] = 1.0
    u_low: Annotated[float, Parameter("m/s", "Lowest demanded speed", -100.0, 100.0)] = 0.0
    u_high: Annotated[float, Parameter("m/s", "Highest demanded speed", -100.0, 100.0)] = 1.6
    w_high: Annotated[float, Parameter("rad/s", "Highest demanded turn rate, either way", 0.0, 100.0, "ω_high")] = 3.5


class Constants(NamedTuple):
    k_p: float
    turn: float
    turn_a: float
    K_1: float
    K_2: float
    K_3: float
    K_4: float
    k_aw: float
    u_low: float
    u_high: float
    w_high: float
    u_min: float
    u_max: float
    w_max: float
    per_u: float
    c_uww: float
    c_u: float
    delta_u: float
    per_w: float
    c_wuw: float
    c_w: float
    delta_w: float


State = tuple[float, float, float, float, float]
Pair = tuple[float, float]


@kernel
def derive(p: PiAntiWindup, trim: Any) -> tuple[float, ...]:
    # comparisons would drop a NaN among the limits: 0 times them propagates it
    turn = p.k_q / (trim.a * trim.a + 1.0) + 0.0 * (p.u_low + p.u_high + p.w_high)
    return (
        p.k_p, turn, turn * trim.a, p.K_1, p.K_2, p.K_3, p.K_4, p.k_aw, p.u_low, p.u_high, p.w_high,
        trim.u_min, trim.u_max, trim.w_max,
        trim.per_u, trim.c_uww, trim.c_u, trim.delta_u, trim.per_w, trim.c_wuw, trim.c_w, trim.delta_w,
    )  # fmt: skip


@kernel
def follow(x: State, demand: Pair, k_p: float, p: Constants) -> Pair:
    s, c = sincos(x[2])
    along = demand[0] * c + demand[1] * s
    left = demand[1] * c - demand[0] * s
    u_d = clip(k_p * along, p.u_low, p.u_high)
    return u_d, clip(p.turn_a * left + p.turn * atan2(left, along), -p.w_high, p.w_high)


@kernel
def follow_force(x: State, demand: Pair, p: Constants) -> Pair:
    return follow(x, demand, p.k_p, p)


@kernel
def follow_velocity(x: State, demand: Pair, p: Constants) -> Pair:
    return follow(x, demand, 1.0, p)


@kernel
def control(x: State, c: Pair, aim: Pair, p: Constants) -> tuple[Pair, Pair]:
    u, w = x[3], x[4]
    e_u = aim[0] - u
    e_w = aim[1] - w
    u_ref = p.K_1 * e_u + p.K_3 * c[0]
    w_ref = p.K_2 * e_w + p.K_4 * c[1]
    a_u = p.c_uww * w * w - p.c_u * u + p.per_u * u_ref + p.delta_u
    a_w = -p.c_wuw * u * w - p.c_w * w + p.per_w * w_ref + p.delta_w
    held_u = ((u >= p.u_max) & (a_u > 0.0)) | ((u <= p.u_min) & (a_u < 0.0))
    held_w = ((w >= p.w_max) & (a_w > 0.0)) | ((w <= -p.w_max) & (a_w < 0.0))
    bled_u = e_u - p.k_aw * a_u
    bled_w = e_w - p.k_aw * a_w
    return (u_ref, w_ref), (bled_u if held_u else e_u, bled_w if held_w else e_w)


@kernel
def prepare(x: State, demand: Pair, p: Constants) -> Pair:
    return 0.0, 0.0


@kernel
def command_force(t: float, x: State, c: Pair, demand: Pair, p: Constants) -> tuple[Pair, Pair]:
    return control(x, c, follow_force(x, demand, p), p)


@kernel
def command_velocity(t: float, x: State, c: Pair, demand: Pair, p: Constants) -> tuple[Pair, Pair]:
    return control(x, c, follow_velocity(x, demand, p), p)


# The loop about trim: straight ahead, half way between the stops; u, omega and both integrals.

Four = tuple[float, float, float, float]


def trimmed(values: Mapping[str, float], trim: Any) -> Trimmed:
    """The loop about a trim with u_d held and omega_d = 0; the integrals balance friction and unmodelled
    accelerations."""
    K_1, K_2, K_3, K_4 = (Fraction(values[f"controller.K_{k}"]) for k in "1234")
    if not K_3 or not K_4:
        raise NoTrim("without integral gains the controller does not reach its references; make K_3 and K_4 positive")
    low, high = max(trim.u_min, values["controller.u_low"]), min(trim.u_max, values["controller.u_high"])
    if not low < high:
        raise NoTrim(f"no speed is between the stops, {low:g} and {high:g} m/s; make u_max larger than u_min")
    u_0, w_0 = (low + high) / 2.0, 0.0
    per_u, per_w = Fraction(trim.per_u), Fraction(trim.per_w)
    c_wuw, along, turning = Fraction(trim.c_wuw), Fraction(trim.c_u), Fraction(trim.c_w)
    u, w, sum_u, sum_w = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    flow: tuple[Polynomial, ...] = (
        {(0, 2, 0, 0): Fraction(trim.c_uww), u: -along - per_u * K_1, sum_u: per_u * K_3},
        {(1, 1, 0, 0): -c_wuw, w: -c_wuw * Fraction(u_0) - turning - per_w * K_2, sum_w: per_w * K_4},
        {u: Fraction(-1)},
        {w: Fraction(-1)},
    )
    sums = (along * Fraction(u_0) - Fraction(trim.delta_u)) / (per_u * K_3), -Fraction(trim.delta_w) / (per_w * K_4)
    references = (("speed", u_0, "m/s"), ("turn rate", w_0, "rad/s"))
    limits = (min(u_0 - low, high - u_0), trim.w_max, None, None)
    return Trimmed((u_0, w_0, *map(float, sums)), flow, limits, (u_0, 0.0), references)


@kernel
def place(d: Four, trim: Four) -> tuple[State, Pair]:
    return (0.0, 0.0, 0.0, trim[0] + d[0], trim[1] + d[1]), (trim[2] + d[2], trim[3] + d[3])


@kernel
def pick(rates: State, inner: Pair) -> Four:
    return rates[3], rates[4], inner[0], inner[1]


component = Controller(
    name="pi_anti_windup",
    title="PI with anti-windup",
    fits=("pioneer_3dx",),
    parameters=PiAntiWindup,
    states=2,
    signals=(Signal("u_demand", "u_d", "m/s"), Signal("omega_demand", "ω_d", "rad/s")),
    prepare={"force": prepare, "velocity": prepare},
    command={"force": command_force, "velocity": command_velocity},
    references={"force": follow_force, "velocity": follow_velocity},
    derived=Derived(Constants, derive),
    orders=(Order(("u_low",), ("u_high",), "lower u_low or raise u_high"),),
    about_trim=AboutTrim(
        (("u", "u", "m/s"), ("omega", "ω", "rad/s"), ("sum_u", "∫e_u", "m"), ("sum_w", "∫e_ω", "rad")),
        trimmed,
        place,
        pick,
    ),
)
