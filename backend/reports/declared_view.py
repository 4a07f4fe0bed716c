"""The plan view that a simulator declares: its own columns and obstacles under the names that `plan_view` draws.

Seen from above, or from the side if nothing moves sideways. Nothing is drawn that is not in the trace or the
declaration, and no closest approach is claimed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from campaigns.results import TraceHead
from campaigns.results.scene import Coordinate, Scene, SceneObstacle
from campaigns.results.trace import TraceObstacle

Point = tuple[float, float]
Data = Mapping[str, Sequence[float | None]]
Values = list[float | None]


@dataclass(frozen=True)
class View:
    """What the axes show, in words, and the outlines of what is no circle in this view."""

    across: str
    up: str
    seen: str
    outlines: tuple[tuple[str, list[Point]], ...] = ()


@dataclass(frozen=True)
class _Plane:
    """Two of the three coordinates, and the sign of the one that is drawn upwards."""

    across: int
    up: int
    sign: float = 1.0

    def of(self, position: Sequence[Coordinate]) -> tuple[Coordinate, Coordinate]:
        whole = [*position, 0.0, 0.0]
        return whole[self.across], whole[self.up]


def drawn(scene: Scene, head: TraceHead, data: Data) -> tuple[TraceHead, dict[str, Values], View]:
    """The header with the declared obstacles, the tracks by the names that are drawn, and the view."""
    plane = _plane(scene)
    found: dict[str, Values] = {}
    found["x"], found["y"] = _track(scene.vehicle.position, plane, data)
    obstacles: list[TraceObstacle] = []
    outlines: list[tuple[str, list[Point]]] = []
    for body in scene.bodies:
        k, track = len(obstacles), _track(body.position, plane, data)
        found[f"obstacle.{k}.x"], found[f"obstacle.{k}.y"] = track
        at = next(([x, y] for x, y in zip(*track, strict=True) if x is not None and y is not None), [])
        obstacles.append(TraceObstacle(title=body.name, position=at, radius=body.radius, moving=True))
    for obstacle in scene.obstacles:
        outline = _outline(obstacle, plane)
        if outline:
            outlines.append((obstacle.name, outline))
        else:
            at = list(_centre(obstacle, plane))
            obstacles.append(TraceObstacle(title=obstacle.name, position=at, radius=obstacle.radius or 0.0))
    across, up = plane.of(scene.vehicle.position)
    minus = "−" if plane.sign < 0 else ""
    names = f"{_named(across, plane.across)}, m", f"{minus}{_named(up, plane.up)}, m"
    seen = "from the side" if plane.up == 2 else "from above"
    placed = head.model_copy(update={"frame": "enu", "obstacles": obstacles, "start": [], "goal": [], "closest": None})
    return placed, found, View(*names, seen, tuple(outlines))


def _plane(scene: Scene) -> _Plane:
    """The picture's plane: from the side if no second coordinate is a column but a third one is, else from above."""
    moving = [scene.vehicle.position, *(body.position for body in scene.bodies)]
    down = scene.frame == "z_down"
    if not any(isinstance(p[1], str) for p in moving) and any(isinstance(c, str) for p in moving for c in p[2:]):
        return _Plane(0, 2, -1.0 if down else 1.0)
    return _Plane(1, 0) if down else _Plane(0, 1)


def _named(coordinate: Coordinate, axis: int) -> str:
    return coordinate if isinstance(coordinate, str) else "xyz"[axis]


def _track(position: Sequence[Coordinate], plane: _Plane, data: Data) -> tuple[Values, Values]:
    rows = len(next(iter(data.values()), []))
    across, up = plane.of(position)
    heights = [None if value is None else plane.sign * value for value in _values(up, data, rows)]
    return _values(across, data, rows), heights


def _values(coordinate: Coordinate, data: Data, rows: int) -> Values:
    """A column, or a number in every row."""
    if isinstance(coordinate, str):
        return list(data.get(coordinate, [None] * rows))
    return [float(coordinate)] * rows


def _centre(obstacle: SceneObstacle, plane: _Plane) -> Point:
    across, up = plane.of(obstacle.position)
    return float(across), plane.sign * float(up)


def _outline(obstacle: SceneObstacle, plane: _Plane) -> list[Point]:
    """The closed outline of a box, and of an upright cylinder from the side; empty for what is a circle."""
    side = plane.up == 2
    if obstacle.shape == "sphere" or (obstacle.shape == "cylinder" and not side):
        return []
    length, width, high = ([*(obstacle.size or ()), 0.0, 0.0, 0.0])[:3]
    angle = obstacle.angle
    if obstacle.shape == "cylinder":
        length = width = 2.0 * (obstacle.radius or 0.0)
        high, angle = obstacle.height or 0.0, 0.0
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = _centre(obstacle, plane)
    if side:
        half = 0.5 * (abs(length * cos) + abs(width * sin))
        corners = [(-half, -high / 2), (half, -high / 2), (half, high / 2), (-half, high / 2)]
    else:
        flat = [(a * length / 2, b * width / 2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        turned = [(a * cos - b * sin, a * sin + b * cos) for a, b in flat]
        corners = [(b, a) if plane.across == 1 else (a, b) for a, b in turned]
    return [(x + a, y + b) for a, b in [*corners, corners[0]]]
