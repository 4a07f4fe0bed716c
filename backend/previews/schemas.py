"""What the API says of a flown preview. Places are in the vehicle's own axes [m]. Start reading at `Preview`."""

from __future__ import annotations

from typing import Literal

from backend.http.schema import Schema
from campaigns.results.base import Status


class PreviewClosest(Schema):
    """The closest approach: when [s], how near, where, and to which obstacle."""

    time: float
    value: float
    position: list[float]
    obstacle: int
    obstacle_position: list[float]


class PreviewIntruder(Schema):
    """Where the centre of a moving obstacle was, row by row."""

    obstacle: int
    x: list[float | None]
    y: list[float | None]
    z: list[float | None]


class PreviewRealisation(Schema):
    """Which realisation of noise and gusts is drawn, of how many, and what it alone came to."""

    seed: int
    seeds: int
    combine: Literal["worst", "mean"]
    value: float | None


class Preview(Schema):
    """The nominal flight of a campaign, thinned; nothing of it is stored."""

    digest: str
    """Of the campaign that was flown."""
    status: Status
    reason: str
    """Why the status is not ok, a sentence."""
    value: float | None
    """Of the criterion that decides; None if there is none."""
    margin: float | None
    """The value less the threshold: above 0 is clear."""
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
    """What the flight took, the compilation of its loop included [s]."""
