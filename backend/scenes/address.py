"""What a view's address says beside the run: `/view/R-0001/F2/t/3.2/dark`. Start reading at `parse`.

In the path, because the viewer's socket keeps the page's path and drops its query.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Literal, cast

Camera = Literal["overview", "top", "side", "encounter"]
CAMERAS: tuple[Camera, ...] = ("overview", "top", "side", "encounter")


@dataclass(frozen=True)
class Address:
    """Start time [s], theme, camera, and which flight is shown beside the nominal one."""

    time: float | None = None
    """None: at the closest approach."""
    dark: bool = False
    camera: Camera = "overview"
    flight: str = "F1"
    """A finding's label; "nominal" for the nominal flight alone."""


def parse(rest: str) -> Address:
    """Read the part of the path behind the run; raises `ValueError` for what is not understood."""
    parts = [part for part in rest.split("/") if part]
    address = Address()
    while parts:
        word = parts.pop(0)
        if word in ("dark", "light"):
            address = replace(address, dark=word == "dark")
        elif word == "nominal" or re.fullmatch(r"F[1-9]\d{0,2}", word):
            address = replace(address, flight=word)
        elif word == "t" and parts:
            address = replace(address, time=_time(parts.pop(0)))
        elif word == "cam" and parts and parts[0] in CAMERAS:
            address = replace(address, camera=cast(Camera, parts.pop(0)))
        else:
            raise ValueError(f"{word!r} is not part of a view's address")
    return address


def _time(text: str) -> float:
    time = float(text)
    if not math.isfinite(time):
        raise ValueError(f"{text!r} is no time")
    return time
