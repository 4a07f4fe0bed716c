"""The 3D view that a simulator declares: which columns of its trace are positions of what, and what does not move.

Stored with each trace, so that a view needs nothing else.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from campaigns.results.base import Result

MOST = 32
"""Bodies, and fixed obstacles."""
FARTHEST = 1e9
"""Largest coordinate and size [m]."""

Number = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Length = Annotated[float, Field(ge=0, le=FARTHEST)]


def _coordinate(value: object) -> object:
    column = isinstance(value, str) and re.fullmatch(r"[a-z][a-z0-9_]{0,59}", value, re.ASCII)
    number = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= FARTHEST
    if not column and not number:
        raise ValueError(
            f"the name of a column or a number of at most {FARTHEST:g} in magnitude is expected, given {value!r:.60}"
        )
    return value


Coordinate = Annotated[str | float, BeforeValidator(_coordinate)]
"""A column of the trace, or a number that stays."""
Position = Annotated[list[Coordinate], Field(min_length=2, max_length=3)]
"""x, y [m] in the plane, or x, y, z in space."""


class _Part(Result):
    """A part of a declaration; when one is read from a descriptor (context), unknown keys are refused."""

    @model_validator(mode="before")
    @classmethod
    def _known(cls, document: Any, info: ValidationInfo) -> Any:
        unknown = [key for key in document if key not in cls.model_fields] if isinstance(document, dict) else []
        if info.context and unknown:
            raise ValueError(f"there is no {unknown[0]!r:.60} here; give {', '.join(cls.model_fields)}")
        return document


class SceneVehicle(_Part):
    """The vehicle. Without an attitude it is drawn along its motion, by default as a ball."""

    position: Position
    quaternion: Annotated[list[Coordinate], Field(min_length=4, max_length=4)] | None = None
    """w, x, y, z: turns the axes of the body into those of the frame."""
    angles: Annotated[list[Coordinate], Field(min_length=3, max_length=3)] | None = None
    """Roll, pitch, yaw, all in rad or all in deg: about z by yaw, then the new y by pitch, then the new x by roll."""
    mesh: Literal["ball", "aircraft", "robot"] | None = None


class SceneBody(_Part):
    """A moving body."""

    name: str = Field(default="", max_length=60)
    position: Position
    radius: Length = 0.0
    """[m]"""


class SceneObstacle(_Part):
    """A fixed obstacle; the position is its centre. Cylinders are upright."""

    name: str = Field(default="", max_length=60)
    shape: Literal["sphere", "cylinder", "box"]
    position: Annotated[list[Number], Field(min_length=2, max_length=3)]
    """[m]"""
    radius: Length | None = None
    """Of a sphere or cylinder [m]."""
    height: Length | None = None
    """Of a cylinder [m]."""
    size: Annotated[list[Length], Field(min_length=2, max_length=3)] | None = None
    """Length, width and height of a box [m]."""
    angle: Number = 0.0
    """Of the length of a box, from the x axis towards the y axis [rad]."""


class Scene(_Part):
    """What is drawn of a trace."""

    frame: Literal["z_up", "z_down"]
    """The axes of all positions: right-handed, z up or z down. The axes of a body are x ahead, and y left, z up or
    y right, z down."""
    vehicle: SceneVehicle
    bodies: Annotated[list[SceneBody], Field(max_length=MOST)] = []
    obstacles: Annotated[list[SceneObstacle], Field(max_length=MOST)] = []

    @property
    def planar(self) -> bool:
        """Whether everything is in the plane."""
        return len(self.vehicle.position) == 2
