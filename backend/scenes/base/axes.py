"""Converts the axes of a flight to those of the scene: x to the right (east), y ahead (north), z up.

The axes of planar robots are unchanged. North, east, down of aircraft becomes east, north, up by a rotation of half a
turn about the line between north and east, so that nothing is mirrored. Bodies are drawn with x forward, y to the left,
z up; body axes with z down differ by half a turn about x.

Source of the rotations: Stevens, Lewis and Johnson, Aircraft Control and Simulation (2016), sections 1.3 and 1.8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Axes:
    frame: Literal["enu", "ned"] = "enu"

    def drawn(self, points: Floats) -> Floats:
        """Convert points (..., 3) in these axes to scene coordinates [m]."""
        return points if self.frame == "enu" else points[..., (1, 0, 2)] * (1.0, 1.0, -1.0)

    def attitude(self, rotation: Floats) -> Floats:
        """Quaternion w, x, y, z that rotates a mesh (x forward, y left, z up) to these roll, pitch, yaw [rad].

        One (3,), or one in every row (m, 3).
        """
        return self.turned(quaternion(rotation))

    def turned(self, attitude: Floats) -> Floats:
        """A quaternion in these axes (..., 4) as one in the scene's: between the two half turns."""
        if self.frame == "enu":
            return attitude
        w, x, y, z = np.moveaxis(attitude, -1, 0)
        found: Floats = -np.sqrt(0.5) * np.stack([w + z, x + y, x - y, w - z], axis=-1)
        return found

    def about_vertical(self, angle: float) -> Floats:
        """Quaternion of a rotation about the vertical, `angle` [rad] from x towards y of these axes.

        For a shape whose length is along x and that is symmetric in z.
        """
        return self.attitude(np.array([0.0, 0.0, angle]))


def axes_of(frame: object) -> Axes:
    """The axes by their name in a trace or a catalogue; planar axes by default."""
    return Axes("ned") if frame == "ned" else Axes()


def quaternion(rotation: Floats) -> Floats:
    """Quaternion (..., 4) of roll, pitch, yaw (..., 3) [rad]: about z, then the new y, then the new x.

    By products of half angles: SciPy, whose numbers these are, takes a third of a second to load.
    """
    half = np.moveaxis(0.5 * rotation, -1, 0)
    (cr, cp, cy), (sr, sp, sy) = np.cos(half), np.sin(half)
    w, x, y, z = cy * cp, -sy * sp, cy * sp, sy * cp
    return np.stack([w * cr - x * sr, w * sr + x * cr, y * cr + z * sr, z * cr - y * sr], axis=-1)


def along(direction: Floats) -> Floats:
    """Quaternion that aligns a mesh's x with a scene direction, with y level; identity for the zero vector."""
    if float(np.linalg.norm(direction)) == 0.0:
        return np.array([1.0, 0.0, 0.0, 0.0])
    x, y, z = direction
    return quaternion(np.array([0.0, -np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)]))


def unit(vector: Floats, otherwise: tuple[float, float, float] = (1.0, 0.0, 0.0)) -> Floats:
    """The unit vector (3,) of a direction; another one for the zero vector."""
    length = float(np.linalg.norm(vector))
    found: Floats = vector / length if length > 0.0 else np.array(otherwise)
    return found


def rotated(turn: Floats, vector: Floats) -> Floats:
    w, axis = turn[0], turn[1:]
    found: Floats = vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)
    return found
