"""Distances to convex shapes: signed distance to the surface, negative inside, and the outward normal there.

For boxes, the arguments are a point's distance outside the slab of each axis; the caller restores the signs.
"""

from __future__ import annotations

import math

from worker.engine.kernels.maths import kernel


@kernel
def outward(x: float, half: float) -> float:
    """Distance of x outside the slab of half width `half`, negative inside."""
    return abs(x) - half


@kernel
def rectangle(x: float, y: float) -> tuple[float, float, float]:
    """Distance and normal, with non-negative components; x, y: distances outside each slab. The corners are sharp."""
    px = 0.0 if x < 0.0 else x
    py = 0.0 if y < 0.0 else y
    far = math.sqrt(px * px + py * py)
    per = 1.0 / (far + 1e-300)
    deep = x if x > y else y
    inside = deep <= 0.0
    nearer_x = 1.0 if x > y else 0.0
    return (
        (deep if inside else far) + 0.0 * (x + y),  # propagates NaN, which comparisons lose
        nearer_x if inside else px * per,
        1.0 - nearer_x if inside else py * per,
    )


@kernel
def cuboid(x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Distance and normal, with non-negative components; x, y, z: distances outside each slab. Edges are sharp."""
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
