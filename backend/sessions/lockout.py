"""Back-off after failed sign-ins, per account and per address, the same for names that do not exist.

An attempt counts as failed before the password is compared, so that concurrent attempts do not pass together. The
counts are in memory: a restart forgets them, and an unauthenticated client causes no writes by them.
Source: OWASP Authentication Cheat Sheet, "Account Lockout".
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from backend.http.networks import network

FORGOTTEN = 3600.0
"""Failures are forgotten so long after the last one [s]."""

MOST = 20_000
"""Accounts and addresses that are remembered; the oldest are forgotten first."""


@dataclass(frozen=True)
class Limit:
    """free: failures without a pause; then pauses double from 1 s to `longest` [s]."""

    free: int
    longest: float

    def pause(self, failures: int) -> float:
        """The pause after so many failures [s]."""
        return 0.0 if failures < self.free else min(self.longest, 2.0 ** min(failures - self.free, 30))


ACCOUNT = Limit(5, 900.0)
ADDRESS = Limit(20, 60.0)
"""A larger number with shorter pauses: many users may share an address, such as that of a proxy."""


@dataclass
class _Count:
    failures: int = 0
    until: float = 0.0
    last: float = 0.0


class Lockout:
    """Counts failures; used on one event loop."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._counts: dict[tuple[str, str], _Count] = {}

    def enter(self, name: str, address: str) -> float:
        """Count an attempt as failed; returns the time to wait instead [s], 0 if the password may be compared."""
        at = self._clock()
        keyed = [(self._count(key, at), limit) for key, limit in _keys(name, address)]
        wait = max(count.until - at for count, _ in keyed)
        if wait > 0:
            return wait
        for count, limit in keyed:
            count.failures, count.last = count.failures + 1, at
            count.until = at + limit.pause(count.failures)
        return 0.0

    def succeeded(self, name: str, address: str) -> None:
        """The password was right: the account's failures are forgotten, and the address has one fewer."""
        (account, _), where = _keys(name, address)
        self._counts.pop(account, None)
        self._one_fewer(*where)

    def not_compared(self, name: str, address: str) -> None:
        """The attempt was refused before its password was compared, and was none."""
        for key, limit in _keys(name, address):
            self._one_fewer(key, limit)

    def _one_fewer(self, key: tuple[str, str], limit: Limit) -> None:
        count = self._counts.get(key)
        if count is not None:
            count.failures = max(0, count.failures - 1)
            count.until = count.last + limit.pause(count.failures)

    def failures(self, name: str) -> int:
        count = self._counts.get(("account", name))
        return 0 if count is None else count.failures

    def _count(self, key: tuple[str, str], at: float) -> _Count:
        count = self._counts.pop(key, None)
        if count is None or at - count.last > max(FORGOTTEN, count.until - count.last):
            count = _Count(last=at)
        self._counts[key] = count  # the last one of the order
        while len(self._counts) > MOST:
            del self._counts[next(iter(self._counts))]
        return count


def seconds(wait: float) -> int:
    """A wait in whole seconds, at least 1."""
    return max(1, math.ceil(wait))


def _keys(name: str, address: str) -> tuple[tuple[tuple[str, str], Limit], tuple[tuple[str, str], Limit]]:
    return (("account", name), ACCOUNT), (("address", network(address)), ADDRESS)
