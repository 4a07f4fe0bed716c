"""Limits the rate of requests of each session and token: a bucket of a minute's requests, which refills evenly.

Source: RFC 2697 (token bucket).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import lru_cache

MOST = 10_000
"""Sessions and tokens remembered; the one that was used longest ago is forgotten, and has a full bucket again."""


class Bucket:
    """So many at once, and one more after every period; used on one event loop."""

    def __init__(self, burst: int, period: float, clock: Callable[[], float] = time.monotonic) -> None:
        """period: [s]."""
        self._burst, self._period, self._clock = float(burst), period, clock
        self._left, self._at = self._burst, clock()

    def wait(self) -> float:
        """Take one; 0, or if there is none now, none is taken and this is the time until there is one [s]."""
        at = self._clock()
        self._left, self._at = min(self._burst, self._left + (at - self._at) / self._period), at
        missing = max(0.0, 1.0 - self._left)
        self._left -= 0.0 if missing else 1.0
        return missing * self._period


class Rates:
    """The buckets; used on one event loop."""

    def __init__(self, per_minute: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.per_minute = per_minute
        self._bucket = lru_cache(MOST)(lambda _: Bucket(per_minute, 60.0 / per_minute, clock))

    def wait(self, key: str) -> int:
        """Count a request of this session or token; 0, or if there were too many the time to wait instead [s]."""
        return math.ceil(self._bucket(key).wait())
