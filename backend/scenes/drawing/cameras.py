"""Positions and targets of the cameras.

Overview, top and side show the whole scene, encounter the closest approach; chase follows the vehicle and intruder the
closest obstacle, so these two move with time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from backend.scenes.base.address import Camera
from backend.scenes.base.axes import Floats
from backend.scenes.base.flight import Closest

Pose = tuple[Floats, Floats]
"""Position and target of a camera [m]."""

FIELD_OF_VIEW = np.radians(40.0)
ASPECT = 1.1
"""Default aspect ratio (width by height), until a browser reports its own."""
MOVING: tuple[Camera, ...] = ("chase", "intruder")
"""Cameras that move with time."""
TOWARDS = {
    "overview": (-0.25, -0.75, 0.8),
    "encounter": (-0.35, -0.7, 0.75),
    "top": (0.0, -1e-3, 1.0),
    "side": (0.0, -1.0, 0.12),
}
"""Directions from target to camera."""


@dataclass(frozen=True)
class Scene:
    """The scene for a camera: centre, points (n, 3), what must stay free, and the length of a vehicle [m]."""

    middle: Floats
    points: Floats
    threshold: float
    unit: float


@dataclass(frozen=True)
class Sight:
    vehicle: Floats
    forward: Floats
    """The direction in which its nose points."""
    obstacle: Floats | None
    """The centre of the obstacle that comes closest."""
    reach: float
    """How far that obstacle extends from its centre [m]."""
    closest: Closest | None


def pose(camera: Camera, scene: Scene, sight: Sight | None, aspect: float = ASPECT) -> Pose:
    """Position and target of the camera; falls back to the overview if its subject does not exist.

    aspect: width by height of the viewport.
    """
    if sight is not None and camera == "chase":
        return _behind(sight, scene.unit)
    if sight is not None and sight.obstacle is not None and camera == "intruder":
        return _from_obstacle(sight.vehicle, sight.obstacle, max(scene.threshold, sight.reach), scene.unit)
    middle, points = scene.middle, scene.points
    kind: str = camera if camera in ("top", "side") else "overview"
    closest = sight.closest if sight else None
    if camera == "encounter" and closest is not None:
        kind = camera
        middle = (closest.position + closest.obstacle) / 2
        reach = max(1.1 * max(closest.value, scene.threshold), 2 * scene.unit)
        points = middle + reach * np.array([*np.eye(3), *-np.eye(3)])
    direction = np.array(TOWARDS[kind]) / np.linalg.norm(TOWARDS[kind])
    return middle + distance(points - middle, direction, aspect) * direction, middle


def begin_at(server: viser.ViserServer, begin: Pose, span: float) -> None:
    """Set the initial camera of a scene of that span [m]."""
    initial: Any = server.initial_camera
    initial.fov = FIELD_OF_VIEW
    initial.position, initial.look_at = begin
    # viser draws the background at one metre; a farther near plane would clip it.
    initial.near, initial.far = min(0.005 * span, 0.5), 100 * span


def _behind(sight: Sight, unit: float) -> Pose:
    """Behind and above the vehicle, level, looking a little ahead of it."""
    ahead = level(sight.forward)
    eye = sight.vehicle - 6.0 * unit * ahead + np.array([0.0, 0.0, 2.4 * unit])
    return eye, sight.vehicle + 3.0 * unit * ahead


def _from_obstacle(vehicle: Floats, obstacle: Floats, free: float, unit: float) -> Pose:
    """Behind the obstacle as seen from the vehicle, outside what must stay free, looking at the vehicle."""
    towards = level(vehicle - obstacle)
    back = 1.6 * free + 3.0 * unit
    return obstacle - back * towards + np.array([0.0, 0.0, 0.55 * back]), vehicle


def level(direction: Floats) -> Floats:
    """The horizontal unit vector of a direction; north if it is vertical."""
    flat = direction * (1.0, 1.0, 0.0)
    length = float(np.linalg.norm(flat))
    if length < 1e-6 * max(float(np.linalg.norm(direction)), 1e-9):
        return np.array([0.0, 1.0, 0.0])
    return flat / length


def distance(points: Floats, direction: Floats, aspect: float = ASPECT) -> float:
    """Distance at which a camera in that direction sees all these points around its target [m]."""
    right = np.cross((0.0, 0.0, 1.0), direction)
    right /= np.linalg.norm(right)
    up = np.cross(direction, right)
    across = np.maximum(np.abs(points @ right) / aspect, np.abs(points @ up))
    return float((1.15 * across / np.tan(FIELD_OF_VIEW / 2) + points @ direction).max())
