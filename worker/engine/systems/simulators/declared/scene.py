"""Checks the 3D view that a simulator declares against the columns of its trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from campaigns.asked.expected import expected
from campaigns.results.scene import Scene, SceneObstacle

Units = Mapping[str, str]
"""The unit of each column."""


def scene_of(document: object, units: Units) -> Scene:
    """The declared view; raises ValueError with a sentence for the first thing that cannot be used."""
    if not units:
        raise ValueError("scene: it draws columns of a trace; declare them under trace")
    try:
        found = Scene.model_validate(document, context=True)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in ("scene", *first["loc"]))
        raise ValueError(f"{place}: {expected(first, Scene)}") from None
    for problem in _problems(found, units):
        raise ValueError(f"scene.{problem}")
    return found


def _problems(scene: Scene, units: Units) -> Iterator[str]:
    many = len(scene.vehicle.position)
    yield from _columns("vehicle.position", scene.vehicle.position, units, ("m",))
    yield from _attitude(scene, units)
    for k, body in enumerate(scene.bodies):
        yield from _columns(f"bodies.{k}.position", body.position, units, ("m",))
    placed = {f"bodies.{k}": len(body.position) for k, body in enumerate(scene.bodies)}
    placed |= {f"obstacles.{k}": len(obstacle.position) for k, obstacle in enumerate(scene.obstacles)}
    for key, count in placed.items():
        if count != many:
            yield f"{key}.position: {many} coordinates are expected, as many as the vehicle has, given {count}"
    for k, obstacle in enumerate(scene.obstacles):
        wrong = _shape(obstacle, scene.planar)
        if wrong:
            yield f"obstacles.{k}{wrong}"


def _attitude(scene: Scene, units: Units) -> Iterator[str]:
    vehicle = scene.vehicle
    if vehicle.quaternion is not None and vehicle.angles is not None:
        yield "vehicle: give quaternion or angles, not both"
    if vehicle.quaternion is not None:
        yield from _columns("vehicle.quaternion", vehicle.quaternion, units, ("", "1"))
    if vehicle.angles is not None:
        yield from _columns("vehicle.angles", vehicle.angles, units, ("rad", "deg"))
        if len({units[c] for c in vehicle.angles if isinstance(c, str) and c in units}) > 1:
            yield "vehicle.angles: all are in rad, or all in deg"


def _columns(key: str, coordinates: Sequence[Any], units: Units, allowed: tuple[str, ...]) -> Iterator[str]:
    """What is wrong with columns that must have one of these units; at least one is a column."""
    names = [name for name in coordinates if isinstance(name, str)]
    if not names:
        yield f"{key}: at least one column of the trace is expected, given numbers only"
    for name in names:
        if name not in units:
            yield f"{key}: the trace has no column {name}; it has {', '.join(units)}"
        elif units[name] not in allowed:
            expected = " or ".join(unit or "no unit" for unit in allowed)
            yield f"{key}: the column {name} is in {units[name] or 'no unit'}; {expected} is expected"


def _shape(obstacle: SceneObstacle, planar: bool) -> str:
    """What an obstacle lacks, or has too much."""
    needs = {"sphere": ("radius",), "cylinder": ("radius",) if planar else ("radius", "height"), "box": ("size",)}
    for key in ("radius", "height", "size"):
        has = getattr(obstacle, key) is not None
        if key in needs[obstacle.shape] and not has:
            return f".{key}: a {obstacle.shape} needs it"
        if has and key not in needs[obstacle.shape] and not (key == "height" and obstacle.shape == "cylinder"):
            return f".{key}: a {obstacle.shape} has none; it has {' and '.join(needs[obstacle.shape])}"
    if obstacle.size is not None and len(obstacle.size) != (2 if planar else 3):
        sides = "length and width" if planar else "length, width and height"
        return f".size: {sides} are expected, given {len(obstacle.size)} numbers"
    return ""
