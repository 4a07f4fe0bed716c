"""The API schemas of a preview. Positions are in the vehicle's world axes [m]."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema
from campaigns.results.base import Status


class PreviewClosest(Schema):
    """The closest approach: time [s], distance, position and obstacle."""

    time: float
    value: float
    position: list[float]
    obstacle: int
    obstacle_position: list[float]


class PreviewIntruder(Schema):
    """The centre of a moving obstacle in each row."""

    obstacle: int
    x: list[float | None]
    y: list[float | None]
    z: list[float | None]


class PreviewRealisation(Schema):
    """The noise and gust realisation that is shown, the number of realisations, and its own value."""

    seed: int
    seeds: int
    combine: Literal["worst", "mean"]
    value: float | None


class Preview(Schema):
    """The nominal flight of a campaign, thinned; nothing of it is stored."""

    digest: str
    """Digest of the simulated campaign."""
    status: Status
    reason: str
    """The reason why the status is not ok, a sentence."""
    value: float | None
    """The value of the deciding criterion; None if there is none."""
    margin: float | None
    """The value minus the threshold: clear above 0."""
    threshold: float
    quantity: str
    unit: str
    frame: Literal["enu", "ned"]
    t: list[float | None]
    """[s]"""
    x: list[float | None]
    y: list[float | None]
    z: list[float | None]
    heading: list[float | None]
    """[rad], from the vehicle's x axis towards its y axis."""
    intruders: list[PreviewIntruder]
    closest: PreviewClosest | None
    realisation: PreviewRealisation | None
    seconds: float
    """The time of the simulation, including compilation [s]."""
