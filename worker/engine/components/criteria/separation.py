"""Separation from centres: the smallest distance to any obstacle's centre over the trajectory.

    d_min = min over t <= T and obstacles of |q(t) - c(t)|,   clear when d_min > threshold

Source: Srikanthakumar, equations 1.1 and 1.2; the threshold is r = r_0 + r_safe. The minimum over time is refined by
the parabola through three samples of the squared distance, so the sampling adds no false minima.
A simulation that starts at or inside the threshold is excluded: it would show nothing.
The extent of the obstacles is ignored: with a threshold below an obstacle's radius the vehicle may be inside it.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Criterion, Parameter
from worker.engine.kernels.maths import kernel
from worker.engine.physics.space import dot3
from worker.engine.physics.vectors import centre, difference, spatial


class Separation(NamedTuple):
    threshold: Annotated[float, Parameter("m", "Safe radius r: d_min must stay above it", 0.0, 1e6, symbol="r")]


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: Separation) -> tuple[float]:
    away = spatial(difference(q, centre(body, q)))
    return (dot3(away, away),)


@kernel
def value(lowest: Any, p: Separation) -> float:
    nearest = lowest[0]
    for square in lowest:
        nearest = square if square < nearest else nearest
    return math.sqrt(nearest if nearest > 0.0 else 0.0)


@kernel
def excluded(first: Any, p: Separation) -> bool:
    return value(first, p) <= p.threshold


component = Criterion(
    name="separation",
    title="Separation from centres",
    quantity="d_min",
    unit="m",
    parameters=Separation,
    sample={2: sample, 3: sample},
    value=value,
    excluded=excluded,
    measured_to="centre",
)
