"""The nominal flights of the shipped campaigns, as their cards draw them: stored with the installation.

`make library-flights` simulates and writes them.
"""

from __future__ import annotations

import functools
import logging
from pathlib import Path
from typing import Literal

from pydantic import TypeAdapter

from campaigns.results.base import Result, Status

_log = logging.getLogger(__name__)

FILE = Path(__file__).parents[1] / "library" / "flights.json"


class DrawnTrack(Result):
    """The centre of a moving obstacle in each row [m]."""

    obstacle: int
    x: list[float]
    y: list[float]


class DrawnClosest(Result):
    """The closest approach: time [s], vehicle and obstacle [m]."""

    time: float
    x: float
    y: float
    obstacle: int
    obstacle_x: float
    obstacle_y: float


class DrawnFlight(Result):
    """The nominal flight of a campaign from above, thinned and rounded, in the vehicle's world axes."""

    digest: str
    """That of the simulated campaign."""
    code: str
    """Identifies the code that was simulated: components, physics and closed loop. 16 hexadecimal digits."""
    status: Status
    reason: str
    """The reason why the status is not ok, a sentence."""
    value: float | None
    """The value of the deciding criterion in its own sign; None unless the status is ok."""
    frame: Literal["enu", "ned"]
    x: list[float]
    """[m]"""
    y: list[float]
    """[m]"""
    tracks: list[DrawnTrack]
    """Of the moving obstacles."""
    closest: DrawnClosest | None
    """None if the criterion is not a distance to obstacles."""


FLIGHTS = TypeAdapter(dict[str, DrawnFlight])
"""By the identifier of the campaign."""


@functools.lru_cache(maxsize=1)
def library_flights() -> dict[str, DrawnFlight]:
    """The stored flights by the identifier of their campaign; none if the file is missing or damaged."""
    try:
        return FLIGHTS.validate_json(FILE.read_bytes())
    except (OSError, ValueError) as error:  # a picture is missing, but nothing that is claimed
        _log.error("%s cannot be read, so the cards of the library have no flights: %s", FILE, error)
        return {}
