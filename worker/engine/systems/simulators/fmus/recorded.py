"""The trace of one simulation of an FMU: variables at the communication points, or at every k-th of them."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from worker.engine.systems.simulators.fmus.job import Recorded

TIME = "time"
Read = Callable[[Any, int, Any], None]
"""Reads so many variables, by their references (array of C), into an array of C."""


class Record:
    """Columns by name while a simulation runs: `see` every communication point in the order of time."""

    def __init__(self, stated: Recorded, steps: int) -> None:
        self._every, self._steps = stated["every"], steps
        self._names = list(stated["columns"])
        count = len(self._names)
        self._references = (ctypes.c_uint * count)(*stated["columns"].values())
        self._values = (ctypes.c_double * count)()
        self.columns: dict[str, list[float]] = {name: [] for name in (TIME, *self._names)}

    def see(self, point: int, time: float, read: Read) -> None:
        """The values at a communication point, the last of which is always recorded."""
        if point % self._every and point != self._steps:
            return
        read(self._references, len(self._names), self._values)
        self.columns[TIME].append(time)
        for name, value in zip(self._names, self._values, strict=True):
            self.columns[name].append(value)
