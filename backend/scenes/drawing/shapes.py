"""Small meshes and outlines, one unit long or wide, to be scaled."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backend.scenes.base.axes import Floats, rotated

STEPS = 96
"""Segments of a circle."""
MOST_DASHES = 400


class Mesh(NamedTuple):
    """Vertices (n, 3) and triangles (m, 3)."""

    vertices: Floats
    faces: NDArray[np.int64]


def unicycle() -> tuple[Mesh, Mesh]:
    """Hull and wheels of a small robot that faces along x, standing on z = 0, one unit long."""
    plan = np.array([(-0.42, -0.26), (0.12, -0.26), (0.5, 0.0), (0.12, 0.26), (-0.42, 0.26)])
    hull = prism(plan, 0.1, 0.34)
    wheels = [_wheel(np.array([-0.1, side * 0.32, 0.18])) for side in (-1.0, 1.0)]
    return hull, join(wheels)


def pioneer() -> tuple[Mesh, Mesh]:
    """Hull, and wheels with sonar ring, of a two-wheeled robot with a caster; along x, on z = 0, one unit long."""
    half = [(-0.42, 0.2), (-0.3, 0.27), (0.24, 0.27), (0.46, 0.14)]
    plan = np.array([(x, -y) for x, y in half] + half[::-1])
    sonar = prism(np.array([(0.2, -0.24), (0.5, -0.12), (0.5, 0.12), (0.2, 0.24)]), 0.3, 0.38)
    wheels = [_wheel(np.array([0.06, side * 0.34, 0.22]), 0.22) for side in (-1.0, 1.0)]
    caster = _wheel(np.array([-0.36, 0.0, 0.1]), 0.1)
    return join([prism(plan, 0.14, 0.3), prism(0.86 * plan, 0.3, 0.44)]), join([sonar, *wheels, caster])


def aircraft() -> tuple[Mesh, Mesh]:
    """Fuselage with wing, and tail with fin, of a small aircraft that faces along x, z up, one unit long."""
    profile = np.array([(0.5, 0.0), (0.47, 0.03), (0.32, 0.06), (0.02, 0.06), (-0.3, 0.03), (-0.5, 0.015), (-0.5, 0.0)])
    fuselage = revolved(profile)
    fuselage = Mesh(fuselage.vertices[:, (2, 0, 1)], fuselage.faces)
    wing = prism(
        np.array([(0.18, 0.0), (0.13, 0.6), (-0.02, 0.6), (-0.06, 0.0), (-0.02, -0.6), (0.13, -0.6)]), 0.04, 0.075
    )
    tail = prism(np.array([(-0.34, 0.0), (-0.38, 0.22), (-0.5, 0.22), (-0.5, -0.22), (-0.38, -0.22)]), 0.0, 0.025)
    upright = prism(np.array([(-0.3, 0.01), (-0.43, 0.24), (-0.52, 0.24), (-0.5, 0.01)]), -0.0125, 0.0125)
    fin = Mesh(upright.vertices[:, (0, 2, 1)], upright.faces[:, ::-1])
    return join([fuselage, wing]), join([tail, fin])


def arrow() -> Mesh:
    """A flat arrow head along x, one unit long, its base at the origin."""
    return prism(np.array([(0.0, -0.32), (1.0, 0.0), (0.0, 0.32)]), -0.03, 0.03)


def arrow_lines(start: Floats, end: Floats, head: float) -> Floats:
    """An arrow as line segments (5, 2, 3): its shaft, and a head of that length with four barbs."""
    along = (end - start) / np.linalg.norm(end - start)
    across = np.cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    sides = (across, -across, np.cross(along, across), -np.cross(along, across))
    return np.array([(start, end), *((end, end - head * along + 0.35 * head * side) for side in sides)])


def capsule(radius: float, height: float) -> Mesh:
    """A capsule: all points within `radius` of a vertical line of that height about the origin."""
    turn = np.linspace(0, np.pi / 2, 7)
    cap = radius * np.column_stack([np.sin(turn), np.cos(turn)])
    up, down = cap, cap[::-1] * (1.0, -1.0)
    ends = np.repeat((0.5 * height, -0.5 * height), len(cap))
    outline = np.vstack([up, down])
    return revolved(np.column_stack([outline[:, 1] + ends, outline[:, 0]]), 24)


def ball() -> tuple[Mesh, Mesh]:
    """A ball of diameter 0.5 without a front, and its equator as a thin disc."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 9)
    disc = np.array([(-0.01, 0.0), (-0.01, 0.27), (0.01, 0.27), (0.01, 0.0)])
    return revolved(0.25 * np.column_stack([np.sin(angles), np.cos(angles)])), revolved(disc)


def body() -> tuple[Mesh, Mesh]:
    """A ball that has a front along x and an upside along z, and looks like no vehicle."""
    hull, _ = ball()
    nose = prism(np.array([(0.2, -0.14), (0.5, 0.0), (0.2, 0.14)]), -0.02, 0.02)
    upright = prism(np.array([(-0.1, 0.2), (0.1, 0.2), (0.0, 0.38)]), -0.02, 0.02)
    return hull, join([nose, Mesh(upright.vertices[:, (0, 2, 1)], upright.faces[:, ::-1])])


def revolved(profile: Floats, steps: int = 12) -> Mesh:
    """A profile (n, 2) of height and radius, turned about z."""
    angles = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    z, radius = np.repeat(profile[:, 0], steps), np.repeat(profile[:, 1], steps)
    turned = np.tile(angles, len(profile))
    vertices = np.column_stack([radius * np.cos(turned), radius * np.sin(turned), z])
    at = steps * np.arange(len(profile) - 1)[:, None] + np.arange(steps)
    beside = steps * np.arange(len(profile) - 1)[:, None] + (np.arange(steps) + 1) % steps
    faces = [(at, beside, beside + steps), (at, beside + steps, at + steps)]
    return Mesh(vertices, np.vstack([np.stack(corners, axis=-1).reshape(-1, 3) for corners in faces]))


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


def _wheel(centre: Floats, radius: float = 0.18) -> Mesh:
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    disc = prism(radius * np.column_stack([np.cos(angles), np.sin(angles)]), -0.05, 0.05)
    return Mesh(disc.vertices[:, (0, 2, 1)] + centre, disc.faces[:, ::-1])


def join(meshes: list[Mesh]) -> Mesh:
    offsets = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    faces = [mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]
    return Mesh(np.vstack([m.vertices for m in meshes]), np.vstack(faces))


def circle(centre: Floats, radius: float, dashes: int | None = None) -> Floats:
    """A horizontal circle as line segments (n, 2, 3); with `dashes`, alternate segments are omitted."""
    angles = np.linspace(0, 2 * np.pi, STEPS + 1)
    points = centre + radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(STEPS + 1)])
    segments = polyline(points)
    if dashes is None:
        return segments
    drawn: Floats = segments[(np.arange(STEPS) * 2 * dashes // STEPS) % 2 == 0]
    return drawn


def rounded(centre: Floats, size: Sequence[float], turn: Floats, radius: float) -> Floats:
    """The dashed offset curve at `radius` from a horizontal rectangle of that size; rotated by w, x, y, z."""
    quarter = np.linspace(0, np.pi / 2, 25)
    corners = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        angles = quarter + k * np.pi / 2
        arc = radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
        corners.append(arc + 0.5 * np.array([sx * size[0], sy * size[1], 0.0]))
    points = np.vstack([*corners, corners[0][:1]])
    outline = np.array([centre + rotated(turn, p) for p in points])
    return dashed(outline, float(np.linalg.norm(np.diff(outline, axis=0), axis=1).sum()) / (2 * 24))


def polyline(points: Floats) -> Floats:
    """Points (m, 3) as line segments (m - 1, 2, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1)


def dashed(points: Floats, dash: float) -> Floats:
    """A path (m, 3) as dashes (n, 2, 3) with gaps of equal length; longer ones if there would be too many."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    whole = float(lengths[-1])
    if whole <= 0.0:
        return np.empty((0, 2, 3))
    dash = max(dash, whole / (2 * MOST_DASHES))
    begins = np.arange(0.0, whole, 2 * dash)
    ends = np.minimum(begins + dash, whole)
    at = [np.column_stack([np.interp(s, lengths, points[:, k]) for k in range(3)]) for s in (begins, ends)]
    return np.stack(at, axis=1)


def even_step(span: float, count: float) -> float:
    """The step of 1, 2 or 5 times a power of ten that divides a span into about `count` parts."""
    raw = span / count
    power = 10.0 ** np.floor(np.log10(raw))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda m: abs(np.log(m * power / raw))) * power)
