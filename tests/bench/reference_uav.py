"""Cases 3 to 5 as plain scalar programs: the reference for the lockstep loop's speed, and an independent formulation.

libm, branches, one flight after another. It is spared work that the lockstep loop does: coefficients and gains are
constants of the compiler, and a flight ends 4 s after its closest approach once it is clear, not at the horizon.
Nothing of the product is used but its parameters and its trim.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from clearance.testing.problems import Problem
from worker.engine.components.controllers.autopilot_wings_level import WingsLevel
from worker.engine.kernels.cached import cached
from worker.engine.physics.aerodynamics import Airframe
from worker.engine.systems.base import Floats

AIR = Airframe()
PILOT: Any = WingsLevel()
INDUCED = 1.0 / (math.pi * AIR.e * AIR.b**2 / AIR.S)
SPIN = AIR.I_p * AIR.omega_p
STATIC, MOVING, DECISION = 3, 4, 5
CLEAR = 3.0e4
"""Squared distance beyond the closest one at which a flight is over [m2]."""


@cached
def held(x: float, low: float, high: float) -> float:
    return low if x < low else (high if x > high else x)


@cached
def slope(s: Any, ds: Any, wanted: Any, m: float, C_mde: float, C_dt: float, trim: Any) -> None:
    """The right-hand side: 12 states of the aircraft, 4 integrators of the autopilot. wanted: u_d, theta_d, psi_d."""
    phi, theta, psi, u, v, w, p, q, r = s[3], s[4], s[5], s[6], s[7], s[8], s[9], s[10], s[11]
    e_theta, e_u = wanted[1] - theta, wanted[0] - u
    turn = wanted[2] - psi
    turn = held(turn - 2 * math.pi * math.floor((turn + math.pi) / (2 * math.pi)), -PILOT.e_max, PILOT.e_max)
    to_e = trim[1] - (PILOT.K_p1 * e_theta + PILOT.K_i1 * s[12] - PILOT.K_d1 * q)
    to_a = -PILOT.K_p2 * phi + PILOT.K_i2 * s[13] - PILOT.K_d2 * p
    to_r = -(PILOT.K_p3 * turn + PILOT.K_i3 * s[14] - PILOT.K_d3 * r)
    to_t = trim[2] + PILOT.K_p4 * e_u + PILOT.K_i4 * s[15]
    de, da = held(to_e, -PILOT.stop, PILOT.stop), held(to_a, -PILOT.stop, PILOT.stop)
    dr, dt = held(to_r, -PILOT.stop, PILOT.stop), held(to_t, 0.0, 1.0)
    ds[12] = 0.0 if (to_e - de) * -e_theta > 0 else e_theta
    ds[13] = 0.0 if (to_a - da) * -phi > 0 else -phi
    ds[14] = 0.0 if (to_r - dr) * -turn > 0 else turn
    ds[15] = 0.0 if (to_t - dt) * e_u > 0 else e_u

    square = u * u + v * v + w * w
    speed = math.sqrt(square)
    alpha, beta = math.atan2(w, u), math.asin(v / speed)
    pressure = 0.5 * AIR.rho * square * AIR.S
    ph, qh, rh = p * AIR.b / (2 * speed), q * AIR.c / (2 * speed), r * AIR.b / (2 * speed)
    lift = AIR.C_L0 + AIR.C_La * alpha + AIR.C_Lq * qh + AIR.C_Lde * de
    drag = AIR.C_D0 + INDUCED * (lift - AIR.C_LD) ** 2
    drag += AIR.C_Dde * abs(de) + AIR.C_Dda * abs(da) + AIR.C_Ddr * abs(dr)
    side = AIR.C_Yb * beta + AIR.C_Yp * ph + AIR.C_Yr * rh + AIR.C_Ydr * dr
    ca, sa, cb, sb = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    x = pressure * (-drag * ca * cb - side * ca * sb + lift * sa)
    y = pressure * (-drag * sb + side * cb)
    z = pressure * (-drag * sa * cb - side * sa * sb - lift * ca)
    thrust = C_dt * dt
    roll = AIR.C_lb * beta + AIR.C_lp * ph + AIR.C_lr * rh + AIR.C_lda * da + AIR.C_ldr * dr
    pitch = AIR.C_m0 + AIR.C_ma * alpha + AIR.C_mq * qh + C_mde * de
    yaw = AIR.C_nb * beta + AIR.C_np * ph + AIR.C_nr * rh + AIR.C_nda * da + AIR.C_ndr * dr
    L = pressure * AIR.b * roll
    M = pressure * AIR.c * pitch - AIR.x_a * z + AIR.z_p * thrust
    N = pressure * AIR.b * yaw + AIR.x_a * y

    cph, sph, cth, sth = math.cos(phi), math.sin(phi), math.cos(theta), math.sin(theta)
    ds[0], ds[1], ds[2] = over_ground(s)
    rate = (q * sph + r * cph) / cth
    ds[3], ds[4], ds[5] = p + rate * sth, q * cph - r * sph, rate
    ds[6] = r * v - q * w - AIR.g * sth + (x + thrust) / m
    ds[7] = p * w - r * u + AIR.g * cth * sph + y / m
    ds[8] = q * u - p * v + AIR.g * cth * cph + z / m
    ds[9] = (L - (AIR.I_zz - AIR.I_yy) * q * r) / AIR.I_xx
    ds[10] = (M - (AIR.I_xx - AIR.I_zz) * p * r + SPIN * r) / AIR.I_yy
    ds[11] = (N - (AIR.I_yy - AIR.I_xx) * p * q - SPIN * q) / AIR.I_zz


@cached
def over_ground(s: Any) -> Any:
    """Velocity in world axes."""
    cph, sph, cth, sth = math.cos(s[3]), math.sin(s[3]), math.cos(s[4]), math.sin(s[4])
    cps, sps, u, v, w = math.cos(s[5]), math.sin(s[5]), s[6], s[7], s[8]
    return (
        cps * cth * u + (cps * sth * sph - sps * cph) * v + (sps * sph + cps * cph * sth) * w,
        sps * cth * u + (cps * cph + sph * sth * sps) * v + (sth * sps * cph - cps * sph) * w,
        -sth * u + cth * sph * v + cth * cph * w,
    )


@cached
def field(s: Any, o: Any, g: Any) -> Any:
    """The force of case 3. o: centre, radius; g: goal, k_att, k_rep, d_0."""
    dx, dy, dz = s[0] - o[0], s[1] - o[1], s[2] - o[2]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    gap = distance - o[6]
    fx, fy, fz = g[3] * (g[0] - s[0]), g[3] * (g[1] - s[1]), g[3] * (g[2] - s[2])
    if gap < g[5]:
        k = g[4] * (1 / gap - 1 / g[5]) / gap**2 / distance
        fx, fy, fz = fx + k * dx, fy + k * dy, fz + k * dz
    return fx, fy, fz


@cached
def moving_field(t: float, s: Any, o: Any, g: Any) -> Any:
    """The force of case 4. o: centre at the start, velocity, radius; g: goal, k_att, eta, rho_0, A_max, floor."""
    rx, ry, rz = o[0] + o[3] * t - s[0], o[1] + o[4] * t - s[1], o[2] + o[5] * t - s[2]
    distance = math.sqrt(rx * rx + ry * ry + rz * rz)
    nx, ny, nz = rx / distance, ry / distance, rz / distance
    vx, vy, vz = over_ground(s)
    wx, wy, wz = vx - o[3], vy - o[4], vz - o[5]
    closing = wx * nx + wy * ny + wz * nz
    rho = distance - o[6]
    gap = rho - closing**2 / (2 * g[6])
    fx, fy, fz = g[3] * (g[0] - s[0]), g[3] * (g[1] - s[1]), g[3] * (g[2] - s[2])
    if closing > 0.0 and gap < g[5]:
        gap, rho = max(gap, g[7]), max(rho, g[7])
        k = g[4] / gap**2
        along, across = k * (1 + closing / g[6]), k * closing / (rho * g[6])
        fx += -along * nx + across * (wx - closing * nx)
        fy += -along * ny + across * (wy - closing * ny)
        fz += -along * nz + across * (wz - closing * nz)
    return fx, fy, fz


@cached
def decision(t: float, s: Any, o: Any, g: Any, e: Any) -> Any:
    """The velocity of case 5, side left, gate 4.

    o: as above; g: planned speed and heading, R_p, range, eta_max; e: du, dpsi, du0, dpsi0.
    """
    rx, ry, rz = o[0] + o[3] * t - s[0], o[1] + o[4] * t - s[1], o[2] + o[5] * t - s[2]
    distance = math.sqrt(rx * rx + ry * ry + rz * rz)
    plan = g[0] * math.cos(g[1]), g[0] * math.sin(g[1]), 0.0
    nx, ny, nz = rx / distance, ry / distance, rz / distance
    vx, vy, vz = over_ground(s)
    if distance >= g[3] or (vx - o[3]) * nx + (vy - o[4]) * ny + (vz - o[5]) * nz <= 0.0:
        return plan
    speed = math.sqrt(o[3] ** 2 + o[4] ** 2) + e[2]
    track = math.atan2(o[4], o[3]) - e[3]
    bx, by = speed * math.cos(track), speed * math.sin(track)
    wx, wy = (g[0] + e[0]) * math.cos(g[1] + e[1]) - bx, (g[0] + e[0]) * math.sin(g[1] + e[1]) - by
    level = math.sqrt(nx * nx + ny * ny)
    hx, hy = ny / level, -nx / level
    xi = math.atan2(wx * hx + wy * hy, wx * nx + wy * ny)
    eta = g[4] if g[2] >= distance else min(math.asin(g[2] / distance), g[4])
    if xi >= eta:
        return plan
    k = math.sqrt(wx * wx + wy * wy) * math.cos(eta - xi)
    c, h = k * math.cos(eta), k * math.sin(eta)
    return c * nx + h * hx + bx, c * ny + h * hy + by, c * nz


@cached
def ask(case: int, t: float, s: Any, o: Any, g: Any, e: Any, trim: Any, wanted: Any) -> None:
    """One guidance sample: what the autopilot is to hold."""
    if case == STATIC:
        fx, fy, fz = field(s, o, g)
    elif case == MOVING:
        fx, fy, fz = moving_field(t, s, o, g)
    else:
        fx, fy, fz = decision(t, s, o, g, e)
    level = math.sqrt(fx * fx + fy * fy)
    k_u, gamma_max = e[4], e[5]
    wanted[0] = held(k_u * math.sqrt(level * level + fz * fz), PILOT.u_min, PILOT.u_max)
    wanted[1] = held(math.atan2(-fz, level), -gamma_max, gamma_max) + trim[0]
    wanted[2] = math.atan2(fy, fx)


@cached
def fly(
    case: int, start: Any, body: Any, o: Any, g: Any, e: Any, trim: Any, dt: float, steps: int, every: int
) -> float:
    """d_min [m] of one flight: Runge-Kutta of order 4, the minimum refined by the parabola through three samples."""
    s, wanted, x = start.copy(), np.empty(3), np.empty(16)
    k1, k2, k3, k4 = np.empty(16), np.empty(16), np.empty(16), np.empty(16)
    m, C_mde, C_dt = body
    lowest = y1 = y2 = 1e18
    when = 0.0
    for i in range(steps + 1):
        t = i * dt
        y0 = (s[0] - o[0] - o[3] * t) ** 2 + (s[1] - o[1] - o[4] * t) ** 2 + (s[2] - o[2] - o[5] * t) ** 2
        bend = y2 - 2 * y1 + y0
        if y0 < lowest:
            lowest, when = y0, t
        if i >= 2 and y1 <= y2 and y1 <= y0 and bend > 0.0:
            lowest = min(lowest, y1 - (y2 - y0) ** 2 / (8 * bend))
        if not (abs(s[4]) < 1.4 and abs(s[3]) < 2.0 and s[6] > 3.0 and abs(s[7]) < s[6]):
            return math.nan
        if i == steps or (t > when + 4.0 and y0 > lowest + CLEAR and y0 > y1):
            break
        y2, y1 = y1, y0
        if i % every == 0:
            ask(case, t, s, o, g, e, trim, wanted)
        slope(s, k1, wanted, m, C_mde, C_dt, trim)
        for j in range(16):
            x[j] = s[j] + 0.5 * dt * k1[j]
        slope(x, k2, wanted, m, C_mde, C_dt, trim)
        for j in range(16):
            x[j] = s[j] + 0.5 * dt * k2[j]
        slope(x, k3, wanted, m, C_mde, C_dt, trim)
        for j in range(16):
            x[j] = s[j] + dt * k3[j]
        slope(x, k4, wanted, m, C_mde, C_dt, trim)
        for j in range(16):
            s[j] += dt / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j])
    return math.sqrt(lowest)


@cached
def fly_all(
    case: int, start: Any, bodies: Any, o: Any, g: Any, errors: Any, trim: Any, dt: float, steps: int, every: int
) -> Any:
    """One flight after another."""
    costs = np.empty(len(bodies))
    for i in range(len(bodies)):
        costs[i] = fly(case, start, bodies[i], o, g, errors[i], trim, dt, steps, every)
    return costs


class Reference:
    """The yardstick for flights of a campaign of case 3, 4 or 5 with wings level: `costs()` gives d_min (m,) [m]."""

    def __init__(self, case: int, problem: Problem, vectors: Floats) -> None:
        def one(prefix: str, *names: str) -> list[float]:
            return [float(vectors[0, problem.paths[f"{prefix}.{n}"]]) for n in names]

        def all_of(prefix: str, *names: str) -> Floats:
            return np.ascontiguousarray(vectors[:, [problem.paths[f"{prefix}.{n}"] for n in names]])

        trim = problem.system.loop.extended["trim"]
        alpha = float(vectors[0, trim.first])
        x, y, z, psi, speed = one("start", "x", "y", "z", "psi", "speed")
        start = np.zeros(16)
        start[:9] = x, y, z, 0.0, alpha, psi, speed * math.cos(alpha), 0.0, speed * math.sin(alpha)
        centre, velocity = one("obstacles.0", "position.x", "position.y", "position.z"), [0.0, 0.0, 0.0]
        if case != STATIC:
            v, heading = one("obstacles.0", "speed", "heading")
            velocity = [v * math.cos(heading), v * math.sin(heading), 0.0]
        errors = np.zeros((len(vectors), 6))
        if case == DECISION:
            errors[:, :4] = all_of("avoider", "du", "dpsi", "du0", "dpsi0")
            law = [*one("goal", "speed", "heading"), *one("avoider", "radius", "range", "eta_max")]
        else:
            names = ("k_att", "k_rep", "d_0") if case == STATIC else ("k_att", "eta", "rho_0", "A_max", "floor")
            law = [*one("goal", "x", "y", "z"), *one("avoider", *names)]
        errors[:, 4:] = all_of("controller", "k_u", "gamma_max")
        obstacle = np.array([*centre, *velocity, *one("obstacles.0", "radius")])
        bodies = all_of("vehicle", "m", "C_mde", "C_dt")
        steps, every = problem.system.counts(problem.system.step)
        at = vectors[0, trim.first : trim.first + 3].copy()
        self.given = (case, start, bodies, obstacle, np.array(law), errors, at, problem.system.step, steps, every)

    def costs(self) -> Floats:
        return np.asarray(fly_all(*self.given))
