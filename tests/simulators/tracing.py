"""Decorated functions that return a trace on request, and some that do so wrongly."""

from __future__ import annotations

from typing import Any

import numpy as np

import clearance

TRACE = {"time": {"unit": "s"}, "height": {"unit": "m", "text": "Above ground", "symbol": "h"}}
RANGE = {"speed": (0.0, 10.0)}


@clearance.simulator(parameters=RANGE, trace=TRACE, slots=1, timeout=5.0)
def thrown(speed: float, trace: bool = False) -> Any:
    """The highest point of a throw."""
    time = np.linspace(0.0, 1.0, 5)
    height = speed * time - 4.905 * time**2
    highest = float(height.max())
    return (highest, {"time": time, "height": height}) if trace else highest


@clearance.simulator(parameters=RANGE, trace=TRACE, isolated=False, vectorized=True)
def together(speed: Any, trace: bool = False) -> Any:
    """The simulator, a batch at a time."""
    time = np.linspace(0.0, 1.0, 5)
    height = speed[:, None] * time - 4.905 * time**2
    highest = height.max(axis=1)
    return (highest, {"time": time.tolist(), "height": list(height[0])}) if trace else highest


def _right() -> Any:
    return 1.0, {"time": [0, 1], "height": [0, 1]}


ACTS: list[tuple[Any, str]] = [
    (lambda: 1.0, "with trace=True it returned 1.0; a pair of its results and a dict of columns is expected"),
    (lambda: (1.0, [0, 1]), "with trace=True its columns are a list; a dict of lists by name is expected"),
    (lambda: (1.0, {"time": [0, 1]}), "its trace lacks height; it has time"),
    (lambda: (1.0, {"time": [0, 1], "height": [1]}), "height of its trace has 1 rows and time has 2"),
    (lambda: (1.0, {"time": np.arange(3.0), "height": np.array([0, np.nan, 1])}), "is nan in row 2"),
    (lambda: (1.0, {"time": [0, 1], "height": np.zeros((2, 1))}), "is [0.0] in row 1"),
    (lambda: (None, {"time": [0, 1], "height": [0, 1]}), "it returned None"),
    (lambda: 1 / 0, "ZeroDivisionError: division by zero, at line"),
    (lambda: (1.0, {"time": [0, 1], "height": object()}), "height"),
    (_right, ""),
]


@clearance.simulator(parameters={"act": (0.0, 20.0)}, trace=TRACE, isolated=False)
def wrong(act: float, trace: bool = False) -> Any:
    """Does what its parameter says when it is asked for a trace."""
    return ACTS[int(act)][0]() if trace else 1.0


@clearance.simulator(parameters={"act": (0.0, 20.0)}, trace=TRACE, slots=1, timeout=5.0)
def wrong_alone(act: float, trace: bool = False) -> Any:
    """The wrong simulator in a process of its own."""
    return ACTS[int(act)][0]() if trace else 1.0
