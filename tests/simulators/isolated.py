"""Decorated functions in processes of their own, whose file is loaded quickly: two basins, and one that misbehaves."""

from __future__ import annotations

import math
import os
import signal
import time
from typing import Any

import clearance

BROKEN, OUTSIDE = 0.98, 1.5
PARAMETERS = {
    "x": clearance.Parameter(-1.0, 2.0, nominal=0.5, unit="m", text="Offset along the track"),
    "y": clearance.Parameter(-1.0, 2.0, nominal=0.45, unit="m", text="Offset across it"),
}
RESULTS = {
    "separation": clearance.Output(unit="m", quantity="d_sep"),
    "effort": clearance.Output(unit="J", worse="high"),
}


@clearance.simulator(parameters=PARAMETERS, results=RESULTS, slots=1, timeout=20.0)
def alone(x: float, y: float) -> dict[str, float]:
    """Two basins, one case at a time; the formula of `two_basins`."""
    if y > OUTSIDE:
        raise clearance.Excluded("starts  outside\nthe range")
    if y > BROKEN:
        raise ValueError(f"no value for y = {y:g} m")
    first = 5.0 * math.exp(-((x - 0.2) ** 2 + (y - 0.7) ** 2) / 0.02)
    second = 3.5 * math.exp(-((x - 0.75) ** 2 + (y - 0.25) ** 2) / 0.02)
    return {"separation": 8.0 - first - second - 0.2 * x, "effort": x}


@clearance.simulator(parameters={"do": (0.0, 9.0)}, slots=1, timeout=1.0, memory=2_000_000_000)
def misbehaving(do: float) -> Any:
    """Does what its parameter says."""
    acts: list[Any] = [
        lambda: 1.5,
        lambda: signal.raise_signal(signal.SIGSEGV),
        lambda: time.sleep(1e6),
        lambda: os._exit(3),
        lambda: 1 / 0,
        lambda: None,
        lambda: bytearray(4_000_000_000),
        lambda: float("nan"),
        lambda: _excluded("starts inside"),
        lambda: _excluded(""),
    ]
    return acts[int(do)]()


def _excluded(reason: str) -> None:
    raise clearance.Excluded(reason)
