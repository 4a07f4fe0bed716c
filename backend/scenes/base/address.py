"""Parses a view's address: `/view/R-0001/F2/t/3.2/cam/chase/dark`.

The state is in the path, because the viewer's socket keeps the page's path but drops its query.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Literal, cast

Camera = Literal["overview", "encounter", "top", "side", "chase", "intruder"]
CAMERAS: tuple[Camera, ...] = ("overview", "encounter", "top", "side", "chase", "intruder")

KEY = r"[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"
"""A random UUID (RFC 9562, version 4) in lower case, with which a page controls the viewer that it opened."""
FLIGHT = r"nominal|F[1-9][0-9]{0,2}"


@dataclass(frozen=True)
class Address:
    """Start time [s], theme, camera, and the flight shown with the nominal one."""

    time: float | None = None
    """None starts at the closest approach."""
    dark: bool = False
    camera: Camera = "overview"
    flight: str = "F1"
    """A finding's label; "nominal" for the nominal flight alone."""
    key: str | None = None
    """The key with which a page controls the view; None if it cannot be controlled."""


def parse(rest: str) -> Address:
    """Parse the path after the run; raises `ValueError` for unknown parts."""
    parts = [part for part in rest.split("/") if part]
    address = Address()
    while parts:
        word = parts.pop(0)
        if word in ("dark", "light"):
            address = replace(address, dark=word == "dark")
        elif re.fullmatch(FLIGHT, word):
            address = replace(address, flight=word)
        elif word == "t" and parts:
            address = replace(address, time=_time(parts.pop(0)))
        elif word == "cam" and parts and parts[0] in CAMERAS:
            address = replace(address, camera=cast(Camera, parts.pop(0)))
        elif word == "key" and parts and re.fullmatch(KEY, parts[0]):
            address = replace(address, key=parts.pop(0))
        else:
            raise ValueError(f"{word!r} is not part of a view's address")
    return address


def _time(text: str) -> float:
    time = float(text)
    if not math.isfinite(time):
        raise ValueError(f"{text!r} is not a time")
    return time
