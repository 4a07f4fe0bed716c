"""Small meshes and outlines, one unit long or wide, to be scaled. Start reading at `unicycle`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Mesh(NamedTuple):
    """Vertices (n, 3) and triangles (m, 3)."""

    vertices: Floats
    faces: NDArray[np.int64]


def unicycle() -> tuple[Mesh, Mesh]:
    """Hull and wheels of a small robot that looks along x, standing on z = 0, one unit long."""
    plan = np.array([(-0.42, -0.26), (0.12, -0.26), (0.5, 0.0), (0.12, 0.26), (-0.42, 0.26)])
    hull = prism(plan, 0.1, 0.34)
    wheels = [_wheel(np.array([-0.1, side * 0.32, 0.18])) for side in (-1.0, 1.0)]
    return hull, join(wheels)


def dart() -> tuple[Mesh, Mesh]:
    """Wings and fin of a small aircraft that looks along x, one unit long."""
    wings = prism(np.array([(0.5, 0.0), (-0.4, 0.45), (-0.2, 0.0), (-0.4, -0.45)]), -0.03, 0.03)
    upright = prism(np.array([(0.1, 0.0), (-0.4, 0.22), (-0.35, 0.0)]), -0.02, 0.02)
    fin = Mesh(upright.vertices[:, (0, 2, 1)], upright.faces[:, ::-1])
    return wings, fin


def prism(outline: Floats, low: float, high: float) -> Mesh:
    """A counterclockwise outline (n, 2), star-shaped about its mean, drawn up from one height to another."""
    n = len(outline)
    middle = outline.mean(axis=0)
    ring = np.vstack([outline, middle])
    vertices = np.vstack([np.column_stack([ring, np.full(n + 1, z)]) for z in (low, high)])
    faces = []
    for i in range(n):
        j = (i + 1) % n
        top = n + 1
        faces += [(j, i, n), (top + i, top + j, top + n), (i, j, top + j), (i, top + j, top + i)]
    return Mesh(vertices, np.array(faces))


def _wheel(centre: Floats) -> Mesh:
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    disc = prism(0.18 * np.column_stack([np.cos(angles), np.sin(angles)]), -0.05, 0.05)
    return Mesh(disc.vertices[:, (0, 2, 1)] + centre, disc.faces[:, ::-1])


def join(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one."""
    offsets = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    faces = [mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]
    return Mesh(np.vstack([m.vertices for m in meshes]), np.vstack(faces))


def circle(centre: Floats, radius: float, dashes: int | None = None, steps: int = 96) -> Floats:
    """A horizontal circle as line segments (n, 2, 3); with `dashes`, every other stretch is left out."""
    angles = np.linspace(0, 2 * np.pi, steps + 1)
    points = centre + radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(steps + 1)])
    segments = polyline(points)
    if dashes is None:
        return segments
    drawn: Floats = segments[(np.arange(steps) * 2 * dashes // steps) % 2 == 0]
    return drawn


def polyline(points: Floats) -> Floats:
    """Points (m, 3) as line segments (m - 1, 2, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1)


def quaternion(rotation: Floats) -> Floats:
    """w, x, y, z of roll, pitch, yaw [rad], turned about z, then y, then x."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rotation / 2), np.sin(rotation / 2)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def even_step(span: float, count: int) -> float:
    """The 1, 2 or 5 times a power of ten that divides a span into about so many."""
    raw = span / count
    power = 10.0 ** np.floor(np.log10(raw))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda m: abs(np.log(m * power / raw))) * power)
