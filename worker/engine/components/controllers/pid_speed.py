"""PID control of a unicycle's speed and turn rate, following a demanded force or velocity.

    e_v = v_d - v                        F   = K_p1 e_v + K_i1 int(e_v) + K_d1 d(e_v)/dt
    e_w = omega_d - omega                tau = K_p2 e_w + K_i2 int(e_w) + K_d2 d(e_w)/dt

From a force D:     v_d = k_p (D . heading),  omega_d = k_theta angle(D, heading)
From a velocity D:  v_d =      D . heading,   omega_d = k_theta angle(D, heading)

angle is wrapped to (-pi, pi]. The derivative acts on the whole error through the first-order filter
N s / (s + N), started at the initial error, so that there is no kick at the start.
Source: Srikanthakumar, equations 3.3 (PID), 3.9, 3.15 and 3.16 (outer loop). N = 15 rad/s is a reconstruction.
About trim, a heading that is held, the turn loop is linear in heading error, turn rate and its two states while
the error is within half a turn; the speed does not enter it.
With J = 0.04 kg m2 the fastest pole of case 1 is about 327 rad/s: the step must stay below 8 ms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import AboutTrim, Controller, Parameter, Polynomial, Signal, Trimmed
from worker.engine.kernels.maths import atan2, kernel, sincos


class PidSpeed(NamedTuple):
    k_p: Annotated[float, Parameter("m/(s N)", "Speed demanded per force", 0.0, 1e3)] = 0.06
    k_theta: Annotated[float, Parameter("1/s", "Turn rate demanded per heading error", 0.0, 1e3, symbol="k_θ")] = 5.0
    K_p1: Annotated[float, Parameter("N s/m", "Speed loop, proportional gain", 0.0, 1e5)] = 6.0
    K_i1: Annotated[float, Parameter("N/m", "Speed loop, integral gain", 0.0, 1e5)] = 0.05
    K_d1: Annotated[float, Parameter("N s2/m", "Speed loop, derivative gain", 0.0, 1e5)] = 0.5
    K_p2: Annotated[float, Parameter("N m s/rad", "Turn loop, proportional gain", 0.0, 1e5)] = 5.0
    K_i2: Annotated[float, Parameter("N m/rad", "Turn loop, integral gain", 0.0, 1e5)] = 0.05
    K_d2: Annotated[float, Parameter("N m s2/rad", "Turn loop, derivative gain", 0.0, 1e5)] = 0.5
    N: Annotated[float, Parameter("rad/s", "Bandwidth of the derivative filter", 1e-3, 1e4)] = 15.0


State = tuple[float, float, float, float, float]
Pair = tuple[float, float]
Memory = tuple[float, float, float, float]


@kernel
def follow_force(x: State, demand: Pair, p: PidSpeed) -> Pair:
    s, c = sincos(x[2])
    along = demand[0] * c + demand[1] * s
    return p.k_p * along, p.k_theta * atan2(demand[1] * c - demand[0] * s, along)


@kernel
def follow_velocity(x: State, demand: Pair, p: PidSpeed) -> Pair:
    s, c = sincos(x[2])
    along = demand[0] * c + demand[1] * s
    return along, p.k_theta * atan2(demand[1] * c - demand[0] * s, along)


@kernel
def control(x: State, c: Memory, aim: Pair, p: PidSpeed) -> tuple[Pair, Memory]:
    sum_v, sum_w, filtered_v, filtered_w = c
    e_v = aim[0] - x[3]
    e_w = aim[1] - x[4]
    d_v = p.N * (e_v - filtered_v)
    d_w = p.N * (e_w - filtered_w)
    force = p.K_p1 * e_v + p.K_i1 * sum_v + p.K_d1 * d_v
    torque = p.K_p2 * e_w + p.K_i2 * sum_w + p.K_d2 * d_w
    return (force, torque), (e_v, e_w, d_v, d_w)


@kernel
def prepare_force(x: State, demand: Pair, p: PidSpeed) -> Memory:
    aim = follow_force(x, demand, p)
    return 0.0, 0.0, aim[0] - x[3], aim[1] - x[4]


@kernel
def prepare_velocity(x: State, demand: Pair, p: PidSpeed) -> Memory:
    aim = follow_velocity(x, demand, p)
    return 0.0, 0.0, aim[0] - x[3], aim[1] - x[4]


@kernel
def command_force(t: float, x: State, c: Memory, demand: Pair, p: PidSpeed) -> tuple[Pair, Memory]:
    return control(x, c, follow_force(x, demand, p), p)


@kernel
def command_velocity(t: float, x: State, c: Memory, demand: Pair, p: PidSpeed) -> tuple[Pair, Memory]:
    return control(x, c, follow_velocity(x, demand, p), p)


# The heading loop about trim: theta, omega, int(e_w) and the filter's state.

FASTEST_TURN = 1e3
"""The envelope of the vehicle [rad/s]."""


def trimmed(values: Mapping[str, float], trim: Any) -> Trimmed:
    """The loop about a trim with a constant direction demanded, omega_d = -k_theta theta."""
    gains = (Fraction(values[f"controller.{name}"]) for name in ("k_theta", "K_p2", "K_i2", "K_d2", "N"))
    k_theta, K_p2, K_i2, K_d2, N = gains
    per_J = Fraction(1.0 / values["vehicle.J"])
    theta, omega, total, filtered = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    error: Polynomial = {theta: -k_theta, omega: Fraction(-1)}
    rate: Polynomial = {theta: -N * k_theta, omega: -N, filtered: -N}
    torque: Polynomial = {
        theta: -(K_p2 + K_d2 * N) * k_theta,
        omega: -(K_p2 + K_d2 * N),
        total: K_i2,
        filtered: -K_d2 * N,
    }
    flow: tuple[Polynomial, ...] = (
        {omega: Fraction(1)},
        {m: c * per_J for m, c in torque.items()},
        error,
        rate,
    )
    return Trimmed(
        (0.0,) * 4, flow, (math.pi, FASTEST_TURN, None, None), (1.0, 0.0), (("heading", 0.0, "rad"),)
    )  # fmt: skip


@kernel
def place(d: Memory, trim: Memory) -> tuple[State, Memory]:
    return (0.0, 0.0, trim[0] + d[0], 0.0, trim[1] + d[1]), (0.0, trim[2] + d[2], 0.0, trim[3] + d[3])


@kernel
def pick(rates: State, inner: Memory) -> Memory:
    return rates[2], rates[4], inner[1], inner[3]


component = Controller(
    name="pid_speed",
    title="PID on speed and turn rate",
    fits=("unicycle",),
    parameters=PidSpeed,
    states=4,
    signals=(Signal("v_demand", "v_d", "m/s"), Signal("omega_demand", "ω_d", "rad/s")),
    prepare={"force": prepare_force, "velocity": prepare_velocity},
    command={"force": command_force, "velocity": command_velocity},
    references={"force": follow_force, "velocity": follow_velocity},
    about_trim=AboutTrim(
        (("theta", "θ", "rad"), ("omega", "ω", "rad/s"), ("sum_w", "∫e_ω", "rad"), ("filtered_w", "x_f", "rad/s")),
        trimmed,
        place,
        pick,
    ),
)
