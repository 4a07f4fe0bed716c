"""The messages of an MCAP export and their JSON schemas: those of Foxglove by name and field, and one of our own.

Foxglove's schemas have more fields; these are the ones that are written.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

FRAME = "scene"
VALUES = "clearance.Values"
"""Named values with units; null: not finite."""

SMALLEST = 0.1
"""Radius of the ball that shows an obstacle without one [m]."""


def _object(**properties: dict[str, object]) -> dict[str, object]:
    return {"type": "object", "properties": properties, "required": list(properties)}


def _list(of: dict[str, object]) -> dict[str, object]:
    return {"type": "array", "items": of}


_NUMBER: dict[str, object] = {"type": "number"}
_TEXT: dict[str, object] = {"type": "string"}
_WHOLE: dict[str, object] = {"type": "integer", "minimum": 0}
_TIME = _object(sec=_WHOLE, nsec={**_WHOLE, "maximum": 999_999_999})
_VECTOR = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_POSE = _object(position=_VECTOR, orientation=_object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER))
_COLOUR = _object(r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_SPHERE = _object(pose=_POSE, size=_VECTOR, color=_COLOUR)
_NONE: dict[str, object] = {"type": "array", "maxItems": 0}
_EMPTY = ("arrows", "cubes", "cylinders", "lines", "triangles", "texts", "models")
_ENTITY = _object(
    timestamp=_TIME,
    frame_id=_TEXT,
    id=_TEXT,
    lifetime=_TIME,
    frame_locked={"type": "boolean"},
    metadata=_NONE,
    spheres=_list(_SPHERE),
    **dict.fromkeys(_EMPTY, _NONE),
)
_VALUE = _object(name=_TEXT, unit=_TEXT, value={"type": ["number", "null"]})

SCHEMAS: dict[str, dict[str, object]] = {
    "foxglove.PoseInFrame": _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE),
    "foxglove.PosesInFrame": _object(timestamp=_TIME, frame_id=_TEXT, poses=_list(_POSE)),
    "foxglove.SceneUpdate": _object(deletions=_NONE, entities=_list(_ENTITY)),
    VALUES: _object(timestamp=_TIME, frame_id=_TEXT, values=_list(_VALUE)),
}
"""By name; encoding jsonschema."""


def stamped(time: float, **content: Any) -> dict[str, object]:
    """A message with its time [s] and frame."""
    return {"timestamp": _stamp(time), "frame_id": FRAME, **content}


def pose(position: Iterable[float], turn: Iterable[float]) -> dict[str, object]:
    """position (3,) [m]; turn w, x, y, z."""
    w, x, y, z = (float(one) for one in turn)
    return {"position": _vector(position), "orientation": {"x": x, "y": y, "z": z, "w": w}}


def entity(name: str, time: float, centre: Iterable[float], radius: float) -> dict[str, object]:
    """An obstacle as a ball that stays until it is replaced."""
    size = 2 * max(radius, SMALLEST)
    grey = {"r": 0.45, "g": 0.5, "b": 0.55, "a": 0.8}
    ball = {"pose": pose(centre, (1.0, 0.0, 0.0, 0.0)), "size": _vector((size, size, size)), "color": grey}
    return {
        **stamped(time),
        "id": name,
        "lifetime": _stamp(0.0),
        "frame_locked": False,
        "metadata": [],
        "spheres": [ball],
        **{kind: [] for kind in _EMPTY},
    }


def _stamp(time: float) -> dict[str, object]:
    whole = round(time * 1e9)
    return {"sec": whole // 10**9, "nsec": whole % 10**9}


def _vector(components: Iterable[float]) -> dict[str, object]:
    return dict(zip("xyz", map(float, components), strict=True))
