"""Separation from surfaces: the smallest distance to any obstacle's surface over the trajectory, negative inside.

    c_min = min over t <= T and obstacles of s(q(t)) - r_b,   clear when c_min > threshold

s is the signed distance from the vehicle's reference point to the obstacle's surface, r_b the radius of a disc or
sphere about that point that contains the vehicle's body; 0 considers the reference point only. The minimum over time is
searched between the steps, so that no obstacle is too thin to be seen: along a straight path the distance to a convex
surface falls to one minimum and rises from there.
A simulation that starts at or inside the threshold is excluded: it would show nothing.
Source: signed distances to boxes and cylinders, Ericson, Real-Time Collision Detection (2005), sections 5.1.3 and
5.1.4; the radius of the body as in Srikanthakumar, equations 1.1 and 1.2 (r_0).
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Criterion, Parameter
from worker.engine.kernels.maths import kernel


class SurfaceSeparation(NamedTuple):
    threshold: Annotated[float, Parameter("m", "Safe distance: c_min must stay above it", 0.0, 1e6, symbol="c")]
    body_radius: Annotated[
        float, Parameter("m", "Radius of the vehicle's body about its reference point", 0.0, 1e5, symbol="r_b")
    ] = 0.0


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: SurfaceSeparation) -> tuple[float]:
    return (body.gap - p.body_radius,)


@kernel
def value(lowest: Any, p: SurfaceSeparation) -> float:
    nearest = lowest[0]
    for gap in lowest:
        nearest = gap if gap < nearest else nearest
    return nearest  # type: ignore[no-any-return]


@kernel
def excluded(first: Any, p: SurfaceSeparation) -> bool:
    return value(first, p) <= p.threshold


component = Criterion(
    name="surface_separation",
    title="Separation from surfaces",
    quantity="c_min",
    unit="m",
    parameters=SurfaceSeparation,
    sample={2: sample, 3: sample},
    value=value,
    excluded=excluded,
    over="searched",
    measured_to="surface",
)
