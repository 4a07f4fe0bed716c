"""Limits how many failed sign-ins are recorded: a client that begins many must not fill the disk."""

from __future__ import annotations

import time
from collections.abc import Callable

BURST = 20
"""Failures that are recorded at once."""

PERIOD = 3.0
"""Interval after which one more is recorded [s]."""


class Noted:
    """A token bucket; used on one event loop."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._left, self._at = float(BURST), clock()

    def due(self) -> bool:
        at = self._clock()
        self._left, self._at = min(float(BURST), self._left + (at - self._at) / PERIOD), at
        if self._left < 1:
            return False
        self._left -= 1
        return True
