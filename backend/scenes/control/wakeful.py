"""Mends a wake-up that viser 1.1.1 can lose, after which a viewer would show nothing new any more.

viser sets an `asyncio.Event` from other threads before it does so on its loop. Where the first falls between a waiter's
look at the flag and its entry among those who wait, the second finds the flag set and wakes nobody, and so does every
later one. Start reading at `Wakeful`.
"""

from __future__ import annotations

import asyncio
from typing import Any

from viser.infra._async_message_buffer import AsyncMessageBuffer


class Wakeful(asyncio.Event):
    """An event whose `set` on the loop wakes whoever waits, set or not; from another thread it only sets."""

    _value: bool
    _waiters: Any

    def set(self) -> None:
        """Set it; the caller in another thread calls this again on the loop, as viser does."""
        self._value = True
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            return
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(True)


_create = AsyncMessageBuffer.__init__


def _wakeful(buffer: AsyncMessageBuffer, *given: Any, **named: Any) -> None:
    _create(buffer, *given, **named)
    buffer.message_event = Wakeful()


def install() -> None:
    """Have all message buffers made from now on wake reliably; more than once does no harm."""
    AsyncMessageBuffer.__init__ = _wakeful  # type: ignore[assignment, method-assign]
