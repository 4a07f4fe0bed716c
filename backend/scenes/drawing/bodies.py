"""An obstacle in one flight: its shape, position and track.

It can differ between flights: a cooperative intruder reacts to the vehicle, and an obstacle's parameters may be
uncertain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from backend.scenes.base.axes import Axes, Floats, rotated, unit
from backend.scenes.base.flight import Flight
from campaigns.looks import ObstacleLook

ALIKE = 2e-3
"""Tracks that differ by less than this fraction of the scene cannot be distinguished."""


@dataclass(frozen=True, eq=False)
class Body:
    """An obstacle as drawn [m]: its size is the radius; radius and height; or length, width and height."""

    number: int
    kind: Literal["round", "cylinder", "box"]
    size: tuple[float, ...]
    place: Floats
    """Its centre; for a moving obstacle, at the start."""
    turn: Floats
    """Orientation as w, x, y, z."""
    flight: Flight | None = None
    """For a moving obstacle, the flight that contains its track."""

    def at(self, time: float) -> Floats:
        return self.place if self.flight is None else self.flight.obstacle(self.number, time)

    def heading(self, time: float) -> Floats:
        """Direction of motion at a time [s]; after it has stopped, the last one; zero if it never moves."""
        if self.flight is None:
            return np.zeros(3)
        steps = np.diff(self.track, axis=0)
        moved = np.flatnonzero(np.linalg.norm(steps, axis=1) > 0.0)
        if len(moved) == 0:
            return np.zeros(3)
        now = int(np.searchsorted(self.flight.time, time, side="right")) - 1
        step: Floats = steps[moved[max(int(np.searchsorted(moved, now, side="right")) - 1, 0)]]
        return step

    def velocity(self, time: float) -> Floats:
        """The velocity of the centre at a time (3,) [m/s]; zero if the obstacle never moves."""
        return np.zeros(3) if self.flight is None else self.flight.obstacle_velocity(self.number, time)

    @property
    def track(self) -> Floats:
        """The track of its centre (m, 3); one point if static."""
        return self.place[None] if self.flight is None else self.flight.tracks[self.number]

    @property
    def extent(self) -> float:
        if self.kind == "round":
            return self.size[0]
        if self.kind == "cylinder":
            return float(np.hypot(self.size[0], self.size[1] / 2))
        return float(np.linalg.norm(self.size)) / 2

    def surface(self, place: Floats, centre: Floats) -> Floats:
        """The point of its surface nearest to `place` (3,), with its centre at `centre` (3,)."""
        away = place - centre
        if self.kind == "round":
            return centre + self.size[0] * unit(away)
        if self.kind == "cylinder":
            out = unit(away * (1.0, 1.0, 0.0))
            radial, level = _outline(np.array([out @ away, away[2]]), np.array([self.size[0], self.size[1] / 2]))
            found: Floats = centre + radial * out + np.array([0.0, 0.0, level])
            return found
        own = rotated(self.turn * (1.0, -1.0, -1.0, -1.0), away)
        return centre + rotated(self.turn, _outline(own, np.array(self.size) / 2))

    def like(self, other: Body, span: float) -> bool:
        """Whether both would look the same in a scene of that span [m]."""
        alike = ALIKE * span
        return (
            self.kind == other.kind
            and np.allclose(self.size, other.size, rtol=1e-6)
            and np.allclose(self.turn, other.turn, atol=1e-6)
            and (self.flight is None) == (other.flight is None)
            and _apart(self, other) <= alike
        )


def _outline(at: Floats, half: Floats) -> Floats:
    """The nearest point of a box's outline, in its own axes; a planar box has no top and bottom faces."""
    point: Floats = np.clip(at, -half, half)
    if (point != at).any():
        return point
    to_face = np.where(half > 0.0, half - np.abs(at), np.inf)
    axis = int(np.argmin(to_face))
    point[axis] = np.copysign(half[axis], at[axis])
    return point


def _apart(one: Body, other: Body) -> float:
    """Maximum distance between the tracks of two bodies while both are defined [m]."""
    if one.flight is None or other.flight is None:
        return float(np.linalg.norm(one.place - other.place))
    if one.flight is other.flight:
        return 0.0
    end = min(one.flight.time[-1], other.flight.time[-1])
    times = np.linspace(0.0, end, 200)
    return max(float(np.linalg.norm(one.at(time) - other.at(time))) for time in times)


def bodies_of(looks: Sequence[ObstacleLook | None], values: Mapping[str, float], flight: Flight) -> list[Body]:
    parameters = {**values, **flight.parameters}
    return [body_of(number, parameters, flight.axes, flight, look) for number, look in enumerate(looks)]


def nearest(bodies: list[Body], place: Floats, time: float) -> Body | None:
    return min(bodies, key=lambda body: float(np.linalg.norm(body.at(time) - place)), default=None)


def body_of(
    number: int, values: Mapping[str, float], axes: Axes, flight: Flight | None, look: ObstacleLook | None = None
) -> Body:
    """The obstacle of that number with these parameters by path; a moving one follows its track in that flight.

    Its shape is that of its look, or derived from its parameters if it declares none.
    """
    prefix = f"obstacles.{number}."

    def value(name: str) -> float:
        found = values.get(prefix + name, 0.0)
        return found if np.isfinite(found) else 0.0

    if look is None:
        look = undeclared({path.removeprefix(prefix): v for path, v in values.items() if path.startswith(prefix)})
    place = axes.drawn(np.array([value(f"position.{axis}") for axis in "xyz"]))
    moves = flight is not None and number in flight.tracks
    if flight is not None and moves:
        place = flight.tracks[number][0]
    turn = axes.about_vertical(value(look.angle))
    follows = flight if moves else None
    if look.shape in ("rectangle", "box"):
        length, width = (value(side) for side in look.sides)
        return Body(number, "box", (length, width, value(look.height)), place, turn, follows)
    if look.shape == "cylinder":
        return Body(number, "cylinder", (value(look.radius), value(look.height)), place, turn, follows)
    return Body(number, "round", (value(look.radius),), place, turn, follows)


def undeclared(names: Mapping[str, float]) -> ObstacleLook:
    """The look of an obstacle that declares none, as in snapshots of earlier versions.

    Its shape depends on which of the parameters length, width, height and radius it has.
    """
    angle = "angle" if "angle" in names else ""
    height = "height" if "height" in names else ""
    if "length" in names:
        return ObstacleLook(shape="box", height=height, sides=("length", "width"), angle=angle)
    radius = "radius" if "radius" in names else ""
    return ObstacleLook(shape="cylinder" if height else "sphere", radius=radius, height=height, angle=angle)
