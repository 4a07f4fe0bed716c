"""Keys by which a frame of a page opens its socket, since a sandboxed frame has neither a session nor an origin.

A page of a signed-in user makes the key, writes it into the address of its frame, and asks the service for the view
with this key. While that request waits, and only then, a socket with the key is that user's. Sources: HTML, 7.1.5,
sandboxing; RFC 6454, 7.3 (`Origin: null`).
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass

from backend.db.access import Visitor

PATIENCE = 4.0
"""How long a socket waits for the page's request, which it may overtake [s]; viser tries again after 5 s."""
MOST_WAITING = 32
"""Number of sockets that wait; a further one is refused at once."""
OPAQUE = "null"
"""The header Origin of a sandboxed document."""

_KEYED = re.compile(r"/view/([^/]+)/(?:(?!key/)[^/]+/)*key/([^/]+)/?")
"""One key, at the end of the address."""


@dataclass(frozen=True, eq=False)
class Voucher:
    """Whose view it is, and whether they are still authenticated."""

    visitor: Visitor
    still: Callable[[], Awaitable[bool]]


class Frames:
    """The keys for which pages wait; used on one event loop."""

    def __init__(self) -> None:
        self.waiting = 0
        self._vouchers: dict[tuple[str, str], list[Voucher]] = {}
        self._changed, self._most = asyncio.Event(), MOST_WAITING

    @contextlib.contextmanager
    def expected(self, run: str, key: str, voucher: Voucher) -> Iterator[None]:
        """Meanwhile a socket of this run with this key is the voucher's; run: as in the address."""
        vouchers = self._vouchers.setdefault((run, key), [])
        vouchers.append(voucher)
        self._tell()
        try:
            yield
        finally:
            vouchers.remove(voucher)
            if not vouchers:
                del self._vouchers[run, key]

    async def voucher(self, path: str) -> Voucher | None:
        """The voucher of a socket's address, once a page waits for it; None if none comes, or its session has ended."""
        named = _KEYED.fullmatch(path)
        if named is None:
            return None
        found = self._newest_voucher(named) or await self._coming(named)
        return found if found is not None and await found.still() else None

    def stop(self) -> None:
        """End all waits, because the service stops."""
        self._most = 0
        self._tell()

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()

    def _newest_voucher(self, named: re.Match[str]) -> Voucher | None:
        vouchers = self._vouchers.get((named[1], named[2]))
        return vouchers[-1] if vouchers else None

    async def _coming(self, named: re.Match[str]) -> Voucher | None:
        if self.waiting >= self._most:
            return None
        self.waiting += 1
        try:
            async with asyncio.timeout(PATIENCE):
                while (found := self._newest_voucher(named)) is None and self._most:
                    await self._changed.wait()
            return found
        except TimeoutError:
            return None
        finally:
            self.waiting -= 1
