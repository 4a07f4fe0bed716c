"""Declarations of how an obstacle or a vehicle is drawn; `campaigns.looks` defines and checks the allowed values."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ObstacleLook:
    """Shape, the parameters that give the sizes, and the kind of path: see `campaigns.looks.ObstacleLook`."""

    shape: str
    radius: str = ""
    height: str = ""
    sides: tuple[str, ...] = ()
    angle: str = ""
    way: str = "still"


@dataclass(frozen=True)
class VehicleLook:
    """The mesh, and the start state that gives the heading."""

    mesh: str
    heading: str = ""
