"""Limits the rate of requests of each session and token: a bucket of a minute's requests, which refills evenly.

Source: RFC 2697 (token bucket).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

MOST = 10_000
"""Sessions and tokens remembered; the one that was used longest ago is forgotten, and has a full bucket again."""


class Bucket:
    """So many at once, and one more after every period; used on one event loop."""

    def __init__(self, burst: int, period: float, clock: Callable[[], float] = time.monotonic) -> None:
        """period: [s]."""
        self._burst, self._period, self._clock = float(burst), period, clock
        self._left, self._at = self._burst, clock()

    def take(self) -> bool:
        """Whether there is one now."""
        at = self._clock()
        self._left, self._at = min(self._burst, self._left + (at - self._at) / self._period), at
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class Rates:
    """The buckets; used on one event loop."""

    def __init__(self, per_minute: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.per_minute = per_minute
        self._clock = clock
        self._left: dict[str, tuple[float, float]] = {}

    def wait(self, key: str) -> int:
        """Count a request of this session or token; 0, or if there were too many the time to wait instead [s]."""
        at = self._clock()
        left, since = self._left.pop(key, (float(self.per_minute), at))
        left = min(float(self.per_minute), left + (at - since) * self.per_minute / 60.0)
        missing = max(0.0, 1.0 - left)
        self._left[key] = (left if missing else left - 1.0, at)  # the last one of the order
        if len(self._left) > MOST:
            del self._left[next(iter(self._left))]
        return math.ceil(missing * 60.0 / self.per_minute)
