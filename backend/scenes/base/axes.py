"""From the axes of a flight to those of the scene: x to the right (east), y ahead (north), z up.

The plane of the robots is drawn as it is. North, east, down of the aircraft becomes east, north, up: a rotation, half a
turn about the line between north and east, so that nothing is mirrored. Bodies are drawn with x forward, y to the left,
z up; body axes with z down are half a turn about x from that. Start reading at `Axes`.

Source of the rotations: Stevens, Lewis and Johnson, Aircraft Control and Simulation (2016), sections 1.3 and 1.8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_HALF = np.sqrt(0.5)
_WORLD = np.array([0.0, _HALF, _HALF, 0.0])
"""w, x, y, z of half a turn about the line between north and east."""
_BODY = np.array([0.0, 1.0, 0.0, 0.0])
"""Half a turn about x."""


@dataclass(frozen=True)
class Axes:
    """The axes in which a flight was computed."""

    frame: Literal["enu", "ned"] = "enu"

    def drawn(self, points: Floats) -> Floats:
        """Where points (..., 3) of these axes are drawn [m]."""
        return points if self.frame == "enu" else points[..., (1, 0, 2)] * (1.0, 1.0, -1.0)

    def attitude(self, rotation: Floats) -> Floats:
        """w, x, y, z that turn a mesh (x forward, y left, z up) to these roll, pitch, yaw [rad]."""
        turned = quaternion(rotation)
        return turned if self.frame == "enu" else product(product(_WORLD, turned), _BODY)

    def about_vertical(self, angle: float) -> Floats:
        """w, x, y, z of a turn about the vertical, `angle` [rad] from the x towards the y axis of these axes.

        Turns a shape whose length lies along x, whichever way up.
        """
        return self.attitude(np.array([0.0, 0.0, angle]))


def axes_of(frame: object) -> Axes:
    """The axes by their name in a trace or a catalogue; robots' axes where there is none."""
    return Axes("ned") if frame == "ned" else Axes()


def quaternion(rotation: Floats) -> Floats:
    """w, x, y, z of roll, pitch, yaw [rad]: turned about z, then the new y, then the new x."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rotation / 2), np.sin(rotation / 2)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def product(a: Floats, b: Floats) -> Floats:
    """The turn b followed by the turn a, as w, x, y, z."""
    scalar = a[0] * b[0] - a[1:] @ b[1:]
    return np.concatenate([[scalar], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


def along(direction: Floats) -> Floats:
    """w, x, y, z that turn a mesh's x along a drawn direction, its y level; the identity for no direction."""
    if float(np.linalg.norm(direction)) == 0.0:
        return np.array([1.0, 0.0, 0.0, 0.0])
    x, y, z = direction
    return quaternion(np.array([0.0, -np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)]))


def rotated(turn: Floats, vector: Floats) -> Floats:
    """A vector (3,) turned by w, x, y, z."""
    w, axis = turn[0], turn[1:]
    found: Floats = vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)
    return found
