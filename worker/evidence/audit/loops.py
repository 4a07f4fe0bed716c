"""The polynomial models of shipped closed loops about their trims, written again from the source.

Srikanthakumar, equations 3.1 to 3.3 with 3.15 (heading loop of the unicycle) and 3.17 to 3.22 (Pioneer).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

Values = Mapping[str, float]
Terms = dict[tuple[int, ...], float]
A, B, C, D = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


class Model(NamedTuple):
    """What a record states of a model."""

    states: list[tuple[str, str, str]]
    """Name, symbol, unit."""
    trim: list[float]
    limits: list[float | None]
    references: list[tuple[str, float, str]]
    flow: list[Terms]


def heading(p: Values) -> Model:
    """The unicycle's heading loop: theta, omega, the integral and the filter of the PID controller."""
    J, k, N = p["vehicle.J"], p["controller.k_theta"], p["controller.N"]
    P, I, F = (p[f"controller.K_{gain}2"] for gain in "pid")
    torque: Terms = {A: -(P + F * N) * k / J, B: -(P + F * N) / J, C: I / J, D: -F * N / J}
    flow: list[Terms] = [{B: 1.0}, torque, {A: -k, B: -1.0}, {A: -N * k, B: -N, D: -N}]
    states = [("theta", "θ", "rad"), ("omega", "ω", "rad/s"), ("sum_w", "∫e_ω", "rad"), ("filtered_w", "x_f", "rad/s")]
    return Model(states, [0.0] * 4, [math.pi, 1e3, None, None], [("heading", 0.0, "rad")], flow)


def speeds(p: Values) -> Model:
    """The Pioneer's speed, turn rate and the integrals of both, half way between the stops of the speed."""
    v = {name.removeprefix("vehicle."): value for name, value in p.items() if name.startswith("vehicle.")}
    K = [p[f"controller.K_{k}"] for k in range(1, 5)]
    q = v["R_a"] / v["k_a"]
    drag = q * (v["k_a"] * v["k_b"] / v["R_a"] + v["B_e"])
    per_PT, per_PR = 1.0 / (2.0 * v["r"] * v["k_PT"]), 1.0 / (2.0 * v["r"] * v["d"] * v["k_PR"])
    one = (q * (v["m"] * v["R_t"] * v["r"] + 2.0 * v["I_e"]) + 2.0 * v["r"] * v["k_DT"]) * per_PT
    turned = v["I_e"] * v["d"] ** 2 + 2.0 * v["R_t"] * v["r"] * (v["I_z"] + v["m"] * v["b"] ** 2)
    two = (q * turned + 2.0 * v["r"] * v["d"] * v["k_DR"]) * per_PR
    lever = q * v["m"] * v["b"] * v["R_t"]
    four, six = drag / (v["r"] * v["k_PT"]) + 1.0, drag * v["d"] / (2.0 * v["r"] * v["k_PR"]) + 1.0
    five = lever / (v["d"] * v["k_PR"])
    low, high = max(v["u_min"], p["controller.u_low"]), min(v["u_max"], p["controller.u_high"])
    u = (low + high) / 2.0
    flow: list[Terms] = [
        {(0, 2, 0, 0): lever / (2.0 * v["k_PT"]) / one, A: -(four + K[0]) / one, C: K[2] / one},
        {(1, 1, 0, 0): -five / two, B: -(five * u + six + K[1]) / two, D: K[3] / two},
        {A: -1.0},
        {B: -1.0},
    ]
    sums = [(four * u - v["delta_u"] * one) / K[2], -v["delta_w"] * two / K[3]]
    states = [("u", "u", "m/s"), ("omega", "ω", "rad/s"), ("sum_u", "∫e_u", "m"), ("sum_w", "∫e_ω", "rad")]
    references = [("speed", u, "m/s"), ("turn rate", 0.0, "rad/s")]
    return Model(states, [u, 0.0, *sums], [min(u - low, high - u), v["w_max"], None, None], references, flow)


MODELS: dict[tuple[str, str], Callable[[Values], Model]] = {
    ("unicycle", "pid_speed"): heading,
    ("pioneer_3dx", "pi_anti_windup"): speeds,
}
"""By vehicle and controller; that of any other is taken from the record."""
