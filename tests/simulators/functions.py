"""Decorated functions: two basins, called in a process of its own or for whole batches, and one that misbehaves."""

from __future__ import annotations

import os
import signal
import time
from typing import Any

import numpy as np

import clearance
from tests.simulators import two_basins

PARAMETERS = {
    "x": clearance.Parameter(-1.0, 2.0, nominal=0.5, unit="m", text="Offset along the track"),
    "y": clearance.Parameter(-1.0, 2.0, nominal=0.45, unit="m", text="Offset across it"),
}
RESULTS = {
    "separation": clearance.Output(unit="m", quantity="d_sep"),
    "effort": clearance.Output(unit="J", worse="high"),
}


def _value(y: float) -> None:
    if y > two_basins.BROKEN:
        raise ValueError(f"no value for y = {y:g} m")


@clearance.simulator(parameters=PARAMETERS, results=RESULTS, slots=1, timeout=20.0)
def alone(x: float, y: float) -> dict[str, float]:
    """Two basins, one case at a time."""
    _value(y)
    return {"separation": float(two_basins.separation(np.float64(x), np.float64(y))), "effort": x}


@clearance.simulator(parameters=PARAMETERS, results=RESULTS, isolated=False, vectorized=True)
def together(x: Any, y: Any) -> dict[str, Any]:
    """Two basins, a batch at a time."""
    return {"separation": np.where(y > two_basins.BROKEN, np.nan, two_basins.separation(x, y)), "effort": x}


@clearance.simulator(parameters={"do": (0.0, 9.0)}, slots=1, timeout=1.0, memory=2_000_000_000)
def misbehaving(do: float) -> Any:
    """Does what its parameter says."""
    acts: list[Any] = [
        lambda: 1.5,
        lambda: os.kill(os.getpid(), signal.SIGSEGV),
        lambda: time.sleep(1e6),
        lambda: os._exit(3),
        lambda: 1 / 0,
        lambda: None,
        lambda: bytearray(4_000_000_000),
        lambda: float("nan"),
    ]
    return acts[int(do)]()
