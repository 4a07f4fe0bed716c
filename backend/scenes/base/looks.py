"""The default look of obstacles."""

from __future__ import annotations

from collections.abc import Mapping

from campaigns.looks import ObstacleLook

__all__ = ["ObstacleLook", "undeclared"]


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
