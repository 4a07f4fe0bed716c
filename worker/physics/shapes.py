"""Distances to convex shapes: gap to the surface, negative inside, and the outward normal there.

Boxes are given how far outside its own slab a point is, per axis; the caller restores the signs. Start at `rectangle`.
"""

from __future__ import annotations

import math

from worker.kernels.maths import kernel, norm2
from worker.kernels.views import Body

Pair = tuple[float, float]


@kernel
def disc(centre: Pair, velocity: Pair, radius: float, q: Pair) -> Body:
    """A circle as seen from q."""
    x, y = q[0] - centre[0], q[1] - centre[1]
    d = norm2(x, y)
    near = 1.0 / (d + 1e-12)
    return Body(centre[0], centre[1], velocity[0], velocity[1], radius, d - radius, x * near, y * near)


@kernel
def outward(x: float, half: float) -> float:
    """How far x is outside the slab of half width `half`, negative inside."""
    return abs(x) - half


@kernel
def rectangle(x: float, y: float) -> tuple[float, float, float]:
    """Gap and normal, components not negative; x, y: how far outside either slab. The corners are sharp."""
    px = 0.0 if x < 0.0 else x
    py = 0.0 if y < 0.0 else y
    far = math.sqrt(px * px + py * py)
    per = 1.0 / (far + 1e-300)
    deep = x if x > y else y
    inside = deep <= 0.0
    nearer_x = 1.0 if x > y else 0.0
    return (
        (deep if inside else far) + 0.0 * (x + y),  # a comparison with NaN is False and would lose it
        nearer_x if inside else px * per,
        1.0 - nearer_x if inside else py * per,
    )


@kernel
def cuboid(x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Gap and normal, components not negative; x, y, z: how far outside each slab. Edges and corners are sharp."""
    px = 0.0 if x < 0.0 else x
    py = 0.0 if y < 0.0 else y
    pz = 0.0 if z < 0.0 else z
    far = math.sqrt(px * px + py * py + pz * pz)
    per = 1.0 / (far + 1e-300)
    flat = x if x > y else y
    deep = flat if flat > z else z
    inside = deep <= 0.0
    in_z = 1.0 if z > flat else 0.0
    in_x = 1.0 - in_z if x > y else 0.0
    return (
        (deep if inside else far) + 0.0 * (x + y + z),
        in_x if inside else px * per,
        1.0 - in_z - in_x if inside else py * per,
        in_z if inside else pz * per,
    )
