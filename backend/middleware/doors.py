"""The open connections of a service by address, and the refused ones; used on one event loop."""

from __future__ import annotations

import asyncio
import ipaddress
import logging
from collections import Counter
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

REPORTED = 60.0
"""Refused connections are reported at most this often [s]."""
MOST_ADDRESSES = 1000
"""Addresses whose refused connections are counted until the next report; those of others are counted together."""
NAMED = 5
"""Addresses that a report names, those with the most refused connections."""
OTHERS = "other addresses"
TURNS, TURN = 8, 0.2
"""Requests of an address at a time, more than a browser sends; the time after which a longer one does not count [s]."""

_log = logging.getLogger(__name__)


class Refusals:
    """Counts refused connections by address, and reports them."""

    def __init__(self) -> None:
        self.counted: Counter[str] = Counter()
        self._reported = -REPORTED

    def note(self, address: str) -> None:
        if not self.counted:
            loop = asyncio.get_running_loop()
            loop.call_at(max(loop.time() + 1.0, self._reported + REPORTED), self._report)
        self.counted[address if address in self.counted or len(self.counted) < MOST_ADDRESSES else OTHERS] += 1

    def _report(self) -> None:
        self._reported = asyncio.get_running_loop().time()
        total, most = self.counted.total(), self.counted.most_common(NAMED)
        by = ", ".join(f"{count:,} of {address}" for address, count in most)
        more = len(self.counted) - len(most)
        _log.warning(
            "%s connections were refused or closed for others: %s%s",
            f"{total:,}",
            by,
            f" and {more:,} more" if more else "",
        )
        self.counted.clear()


class Doors:
    """Counts the open connections of each address."""

    def __init__(self, most: int, each: int, trusted: Sequence[str] = (), root: str = "") -> None:
        """most, each: maximum number in total and of an address. trusted: addresses and networks of proxies, which many
        clients share. root: the path of the public address."""
        self.most, self.each, self.root = most, each, root
        self._proxies = [ipaddress.ip_network(one) for one in trusted]
        self.refusals = Refusals()
        self._open: Counter[str] = Counter()
        self._turns: dict[str, asyncio.Semaphore] = {}

    def enter(self, address: str) -> None:
        self._open[address] += 1

    def leave(self, address: str) -> None:
        self._open[address] -= 1
        if not self._open[address]:
            del self._open[address]
            self._turns.pop(address, None)

    def of(self, address: str) -> int:
        return self._open[address]

    @asynccontextmanager
    async def turn(self, address: str) -> AsyncIterator[None]:
        """The turn of a request, when it comes; it ends with the request, or earlier if that takes long.

        Requests of one address wait for each other, so that those of others do not wait for all of them.
        """
        if self._is_proxy(address):
            yield
            return
        turns = self._turns.setdefault(address, asyncio.Semaphore(TURNS))
        await turns.acquire()
        loop, ended = asyncio.get_running_loop(), False

        def end() -> None:
            nonlocal ended
            if not ended:
                ended = True
                turns.release()

        timer = loop.call_later(TURN, end)
        try:
            yield
        finally:
            timer.cancel()
            end()

    def crowded(self, address: str) -> bool:
        """Whether an address has more connections than it may have."""
        return self._open[address] > self.each and not self._is_proxy(address)

    def _is_proxy(self, address: str) -> bool:
        try:
            there = ipaddress.ip_network(address)
        except ValueError:
            return False
        return any(there.version == one.version and there.overlaps(one) for one in self._proxies)
