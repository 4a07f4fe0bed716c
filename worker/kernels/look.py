"""How an obstacle or a vehicle is drawn, as it declares it: `campaigns.looks` lists what there is and checks it.

Start reading at `ObstacleLook`.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ObstacleLook:
    """Its shape, the parameters that give its sizes, and the kind of its way: see `campaigns.looks.ObstacleLook`."""

    shape: str
    radius: str = ""
    height: str = ""
    sides: tuple[str, ...] = ()
    angle: str = ""
    way: str = "still"


@dataclass(frozen=True)
class VehicleLook:
    """Its mesh, and the start state that is its heading."""

    mesh: str
    heading: str = ""
