"""What a simulator declares of its 3D view, as arrays: positions, turns and tracks from the columns of its trace.

Nothing is drawn that is not in the trace or in the declaration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.scenes.base.axes import Axes, Floats, along, quaternion
from campaigns.looks import ObstacleLook
from campaigns.results.scene import FARTHEST, Coordinate, Scene, SceneObstacle, SceneVehicle

LEAST = 1e-6
"""A quaternion shorter than this has no direction."""


@dataclass(frozen=True)
class Motion:
    """Rows in which everything has a position, in scene coordinates [m]: of the trace, the vehicle, the bodies.

    turns (m, 4): the vehicle's, as w, x, y, z of unit length without a change of sign from row to row. tracks: of each
    body (m, 3), numbered after the fixed obstacles.
    """

    rows: NDArray[np.bool_]
    position: Floats
    turns: Floats
    tracks: dict[int, Floats]


def axes_in(scene: Scene) -> Axes:
    return Axes("ned" if scene.frame == "z_down" else "enu")


def motion(scene: Scene, columns: Mapping[str, Floats], units: Mapping[str, str], time: Floats) -> Motion:
    """What moves; rows in which a position or the attitude is missing or out of range are left out."""
    axes, first = axes_in(scene), len(scene.obstacles)
    placed = {first + k: _places(body.position, columns, len(time)) for k, body in enumerate(scene.bodies)}
    position = _places(scene.vehicle.position, columns, len(time))
    attitude = _attitude(scene.vehicle, columns, units, len(time))
    every = np.column_stack([position, *placed.values()])
    known = np.isfinite(time) & (np.abs(every) <= FARTHEST).all(axis=1)
    if attitude is not None:
        known &= np.isfinite(attitude).all(axis=1)
    found = axes.drawn(position[known])
    tracks = {number: axes.drawn(track[known]) for number, track in placed.items()}
    turns = _along(found) if attitude is None else axes.turned(attitude[known])
    return Motion(known, found, _steady(turns.reshape(-1, 4)), tracks)


def values(scene: Scene) -> dict[str, float]:
    """Positions and sizes of the obstacles and bodies by path, as the drawing of a scenario expects them."""
    axes = "xyz"
    found: dict[str, float] = {}
    for k, obstacle in enumerate(scene.obstacles):
        length, width, height = ([*(obstacle.size or ()), 0.0, 0.0, 0.0])[:3]
        sizes = {"radius": obstacle.radius or 0.0, "length": length, "width": width, "angle": obstacle.angle}
        sizes["height"] = (obstacle.height or 0.0) if obstacle.shape == "cylinder" else height
        sizes |= {f"position.{axis}": value for axis, value in zip(axes, obstacle.position, strict=False)}
        found |= {f"obstacles.{k}.{name}": value for name, value in sizes.items()}
    for k, body in enumerate(scene.bodies, len(scene.obstacles)):
        found[f"obstacles.{k}.radius"] = body.radius
    return found


def looks(scene: Scene) -> tuple[ObstacleLook, ...]:
    return (*map(_look, scene.obstacles), *(ObstacleLook(shape="sphere", radius="radius") for _ in scene.bodies))


def names(scene: Scene) -> tuple[str, ...]:
    """The names of the obstacles and bodies; empty where none is given."""
    return (*(obstacle.name for obstacle in scene.obstacles), *(body.name for body in scene.bodies))


def _look(obstacle: SceneObstacle) -> ObstacleLook:
    if obstacle.shape == "box":
        return ObstacleLook(shape="box", sides=("length", "width"), height="height", angle="angle")
    if obstacle.shape == "cylinder":
        return ObstacleLook(shape="cylinder", radius="radius", height="height")
    return ObstacleLook(shape="sphere", radius="radius")


def _places(position: Sequence[Coordinate], columns: Mapping[str, Floats], count: int) -> Floats:
    """Positions (m, 3); in the plane z is zero."""
    return np.column_stack([_column(c, columns, count) for c in (*position, 0.0)[:3]])


def _column(coordinate: Coordinate, columns: Mapping[str, Floats], count: int) -> Floats:
    """A column, or a number in every row; NaN where the trace lacks the column."""
    if isinstance(coordinate, str):
        return columns.get(coordinate, np.full(count, np.nan))
    return np.full(count, float(coordinate))


def _attitude(
    vehicle: SceneVehicle, columns: Mapping[str, Floats], units: Mapping[str, str], count: int
) -> Floats | None:
    """Quaternions (m, 4) in the axes of the trace; None if none is declared."""
    if vehicle.quaternion is not None:
        found = np.column_stack([_column(c, columns, count) for c in vehicle.quaternion])
        size = np.linalg.norm(found, axis=1, keepdims=True)
        return np.where(size > LEAST, found / np.maximum(size, LEAST), np.nan)
    if vehicle.angles is not None:
        degrees = any(isinstance(c, str) and units.get(c) == "deg" for c in vehicle.angles)
        angles = np.column_stack([_column(c, columns, count) for c in vehicle.angles])
        return quaternion(np.radians(angles) if degrees else angles)
    return None


def _along(position: Floats) -> Floats:
    """Turns along the motion, in scene coordinates; where nothing moves, as before, and at first as afterwards."""
    steps = np.diff(position, axis=0, append=position[-1:])
    moved = np.flatnonzero(np.linalg.norm(steps, axis=1) > 0.0)
    if len(moved) == 0:
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(position), 1))
    latest = np.clip(np.searchsorted(moved, np.arange(len(position)), side="right") - 1, 0, None)
    return np.array([along(steps[row]) for row in moved[latest]])


def _steady(turns: Floats) -> Floats:
    """The quaternions with the signs that change least from row to row, so that they can be interpolated."""
    signs = np.where((turns[1:] * turns[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
    return turns * np.cumprod(np.concatenate([[1.0], signs]))[: len(turns), None]
