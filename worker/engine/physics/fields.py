"""Strengths of artificial potential fields as scalars; the avoiders in the plane and in space add the directions.

Khatib (1986), FIRAS; Ge and Cui (2000), GNRON; Ge and Cui (2002), moving obstacles; Choset et al., Principles of Robot
Motion (2005), section 4.1, conic-quadratic attraction. All forces are finite, because distances have a lower limit.
"""

from __future__ import annotations

from worker.engine.kernels.maths import kernel, whole

NEAREST = 1e-3
"""Below this distance from a surface a repulsion keeps its value at this distance [m]."""


@kernel
def attraction(distance: float, k: float, s: float) -> float:
    """Force per displacement to the goal [N/m]: k within the distance s; beyond it the force is constant, k s."""
    conic = k * s / (distance + 1e-300)
    return conic if distance > s else k


@kernel
def cruise(distance: float, speed: float, k: float) -> float:
    """Velocity per displacement to the goal [1/s]: constant `speed`, and k times the distance near the goal."""
    rate = speed / (distance + 1e-300)
    return k if rate > k else rate


@kernel
def firas(gap: float, k: float, d_0: float) -> float:
    """Force away from the surface [N] at the distance `gap`, from the potential 1/2 k (1/gap - 1/d_0)^2 within d_0."""
    d = NEAREST if gap < NEAREST else gap
    strength = k * (d_0 - d) / (d_0 * d * d * d)
    return 0.0 if d > d_0 else strength


@kernel
def gnron(gap: float, goal: float, k: float, d_0: float, n: float) -> tuple[float, float]:
    """Forces away from the surface [N] and per displacement to the goal [N/m].

    The potential is 1/2 k (1/gap - 1/d_0)^2 goal^n within d_0; goal: distance to the goal [m]; n: 0 (FIRAS) to 3,
    rounded.
    """
    n = whole(n)
    d = NEAREST if gap < NEAREST else gap
    steep = (d_0 - d) / (d_0 * d)
    once = 1.0 / (goal + 1e-12)
    power = 1.0 if n < 0.5 else goal
    power = goal * goal if n >= 1.5 else power
    power = goal * goal * goal if n >= 2.5 else power
    lower = once if n < 1.5 else (1.0 if n < 2.5 else goal)  # goal^(n - 2), where n is not 0
    away = k * steep * power / (d * d)
    back = 0.5 * n * k * steep * steep * lower
    return (0.0 if d > d_0 else away), (0.0 if d > d_0 else back)


@kernel
def relative(gap: float, closing: float, eta: float, rho_0: float, a: float, floor: float) -> tuple[float, float]:
    """Forces from an approaching obstacle: along the unit vector to it [N], and per velocity across that vector.

    gap: distance from its surface [m]; closing: closing speed [m/s]; a: maximum deceleration [m/s2]; floor: lower limit
    of the gap and of the gap left after braking [m].
    """
    per_a = 1.0 / a
    left = gap - 0.5 * closing * closing * per_a
    active = (closing > 0.0) & (left < rho_0)
    left = floor if left < floor else left
    near = floor if gap < floor else gap
    g = eta / (left * left)
    along = -g * (1.0 + closing * per_a)
    across = g * closing * per_a / near
    nothing = 0.0 * (left + rho_0)  # not 0.0: propagates NaN, which comparisons lose
    return (along if active else nothing), (across if active else nothing)
