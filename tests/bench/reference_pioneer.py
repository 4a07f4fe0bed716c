"""Case 2 as one plain scalar program: the reference for the lockstep loop's speed, and an independent formulation.

Nothing of the product is used but its parameters: libm, branches, one flight after another.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from clearance.testing.problems import Problem
from worker.engine.kernels.cached import cached
from worker.engine.systems.base import Floats

NAMES = (
    "m", "I_z", "R_t", "r", "k_a", "R_a", "I_e", "B_e", "k_b", "d", "a", "b", "k_PT", "k_PR", "k_DT", "k_DR",
    "u_s", "delta_u", "delta_w", "u_min", "u_max", "w_max",
)  # fmt: skip
"""The order of the vehicle's parameters below."""


@cached
def thetas(p: Any) -> Any:
    """theta_1 to theta_6 of equation 3.19."""
    m, I_z, R_t, r, k_a, R_a, I_e, B_e, k_b, d, _, b, k_PT, k_PR, k_DT, k_DR = p[:16]
    q = R_a / k_a
    f = k_a * k_b / R_a + B_e
    return (
        (q * (m * R_t * r + 2 * I_e) + 2 * r * k_DT) / (2 * r * k_PT),
        (q * (I_e * d * d + 2 * R_t * r * (I_z + m * b * b)) + 2 * r * d * k_DR) / (2 * r * d * k_PR),
        q * m * b * R_t / (2 * k_PT),
        q * f / (r * k_PT) + 1,
        q * m * b * R_t / (d * k_PR),
        q * f * d / (2 * r * k_PR) + 1,
    )


@cached
def held(value: float, low: float, high: float) -> float:
    return low if value < low else high if value > high else value


@cached
def slope(t: float, s: Any, p: Any, c: Any, e: Any, th: Any) -> Any:
    """The right-hand side. p: vehicle; c: controller and avoider; e: the encounter."""
    x, y, psi, u, w, sum_u, sum_w = s
    a, u_s, delta_u, delta_w, u_min, u_max, w_max = p[10], p[16], p[17], p[18], p[19], p[20], p[21]
    k_p, k_q, K_1, K_2, K_3, K_4, k_aw, u_low, u_high, w_high, k_att, eta, rho_0, A_max, floor = c
    goal_x, goal_y, x0, y0, stop_x, stop_y, speed, radius, dx, dy = e
    cos, sin = math.cos(psi), math.sin(psi)
    u = held(u, u_min, u_max)
    w = held(w, -w_max, w_max)
    vx = u * cos - a * w * sin - u_s * sin
    vy = u * sin + a * w * cos + u_s * cos

    way = math.sqrt((stop_x - x0) ** 2 + (stop_y - y0) ** 2)
    ox, oy, ovx, ovy = stop_x, stop_y, 0.0, 0.0
    if t * speed < way:
        ovx, ovy = speed * (stop_x - x0) / way, speed * (stop_y - y0) / way
        ox, oy = x0 + ovx * t, y0 + ovy * t
    rx, ry = ox + dx - x, oy + dy - y
    distance = math.sqrt(rx * rx + ry * ry)
    nx, ny = rx / distance, ry / distance
    wx, wy = vx - ovx, vy - ovy
    closing = wx * nx + wy * ny
    fx, fy = k_att * (goal_x - x), k_att * (goal_y - y)
    if closing > 0.0:
        rho = distance - radius
        gap = rho - closing**2 / (2 * A_max)
        if gap < rho_0:
            gap = max(gap, floor)
            rho = max(rho, floor)
            g = eta / gap**2
            fx += -g * (1 + closing / A_max) * nx + g * closing / (rho * A_max) * (wx - closing * nx)
            fy += -g * (1 + closing / A_max) * ny + g * closing / (rho * A_max) * (wy - closing * ny)

    turn = 0.0
    if fx != 0.0 or fy != 0.0:
        turn = math.atan2(fy, fx) - psi
        turn -= 2 * math.pi * math.floor((turn + math.pi) / (2 * math.pi))
    u_d = held(k_p * (fx * cos + fy * sin), u_low, u_high)
    w_d = held(k_q / (a * a + 1) * (-a * fx * sin + a * fy * cos + turn), -w_high, w_high)
    e_u, e_w = u_d - u, w_d - w
    du = (th[2] * w * w - th[3] * u + K_1 * e_u + K_3 * sum_u) / th[0] + delta_u
    dw = (-th[4] * u * w - th[5] * w + K_2 * e_w + K_4 * sum_w) / th[1] + delta_w
    if (u >= u_max and du > 0.0) or (u <= u_min and du < 0.0):
        e_u -= k_aw * du
        du = 0.0
    if (w >= w_max and dw > 0.0) or (w <= -w_max and dw < 0.0):
        e_w -= k_aw * dw
        dw = 0.0
    return vx, vy, w, du, dw, e_u, e_w


@cached
def moved(s: Any, h: float, k: Any) -> Any:
    return (
        s[0] + h * k[0], s[1] + h * k[1], s[2] + h * k[2], s[3] + h * k[3],
        s[4] + h * k[4], s[5] + h * k[5], s[6] + h * k[6],
    )  # fmt: skip


@cached
def square(t: float, s: Any, e: Any) -> float:
    """Squared distance from the intruder."""
    way = math.sqrt((e[4] - e[2]) ** 2 + (e[5] - e[3]) ** 2)
    share = min(t * e[6] / way, 1.0)
    return (e[2] + share * (e[4] - e[2]) - s[0]) ** 2 + (e[3] + share * (e[5] - e[3]) - s[1]) ** 2  # type: ignore[no-any-return]


@cached
def fly(s: Any, p: Any, c: Any, e: Any, dt: float, steps: int) -> float:
    """d_min [m] of one flight: Runge-Kutta of order 4, the minimum refined by the parabola through three samples."""
    th = thetas(p)
    y2 = y1 = lowest = square(0.0, s, e)
    for i in range(steps):
        t = i * dt
        k1 = slope(t, s, p, c, e, th)
        k2 = slope(t + dt / 2, moved(s, dt / 2, k1), p, c, e, th)
        k3 = slope(t + dt / 2, moved(s, dt / 2, k2), p, c, e, th)
        k4 = slope(t + dt, moved(s, dt, k3), p, c, e, th)
        s = moved(moved(moved(moved(s, dt / 6, k1), dt / 3, k2), dt / 3, k3), dt / 6, k4)
        s = (s[0], s[1], s[2], held(s[3], p[19], p[20]), held(s[4], -p[21], p[21]), s[5], s[6])
        y0 = square(t + dt, s, e)
        low = y0
        bend = y2 - 2 * y1 + y0
        if i > 0 and y1 <= y2 and y1 <= y0 and bend > 0.0:
            low = y1 - (y2 - y0) ** 2 / (8 * bend)
        lowest = min(lowest, low)
        y2, y1 = y1, y0
    return math.sqrt(lowest)


@cached
def fly_all(starts: Any, vehicles: Any, laws: Any, encounters: Any, dt: float, steps: int, costs: Any) -> None:
    """One flight after another."""
    for i in range(len(costs)):
        s = (starts[i, 0], starts[i, 1], starts[i, 2], starts[i, 3], starts[i, 4], 0.0, 0.0)
        # tuples stay in registers
        p, c, e = to_fixed_tuple(vehicles[i], 22), to_fixed_tuple(laws[i], 15), to_fixed_tuple(encounters[i], 10)
        costs[i] = fly(s, p, c, e, dt, steps)


class Reference:
    """The reference for simulations of a campaign of case 2: `costs()` simulates all and returns d_min (m,) [m]."""

    def __init__(self, problem: Problem, vectors: Floats) -> None:
        def of(prefix: str, *names: str) -> Floats:
            return np.ascontiguousarray(vectors[:, [problem.paths[f"{prefix}.{n}"] for n in names]])

        self.steps, self.dt = problem.system.counts(problem.system.step)[0], problem.system.step
        self.starts = of("start", "x", "y", "psi", "u", "omega")
        self.vehicles = of("vehicle", *NAMES)
        gains = of("controller", "k_p", "k_q", "K_1", "K_2", "K_3", "K_4", "k_aw", "u_low", "u_high", "w_high")
        self.laws = np.hstack([gains, of("avoider", "k_att", "eta", "rho_0", "A_max", "floor")])
        intruder = of("obstacles.0", "position.x", "position.y", "goal.x", "goal.y", "speed", "radius")
        self.encounters = np.hstack([of("goal", "x", "y"), intruder, of("faults.0", "dx", "dy")])

    def costs(self) -> Floats:
        found = np.empty(len(self.starts))
        fly_all(self.starts, self.vehicles, self.laws, self.encounters, self.dt, self.steps, found)
        return found
