"""Works around a lost wake-up in viser 1.1.1, after which a viewer would no longer be updated.

viser sets an `asyncio.Event` from another thread before it sets it on its loop. If the first call comes between a
waiter's check of the flag and its registration, the second call finds the flag set and wakes no waiter; so does every
later one.
"""

from __future__ import annotations

import asyncio
from typing import Any

from viser.infra._async_message_buffer import AsyncMessageBuffer


class Wakeful(asyncio.Event):
    """An event whose `set` on the loop always wakes all waiters; from another thread it only sets the flag."""

    _value: bool
    _waiters: Any

    def set(self) -> None:
        """Set the flag; a caller in another thread must call this again on the loop, as viser does."""
        self._value = True
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            return
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(True)


_create = AsyncMessageBuffer.__init__


def _wakeful(buffer: AsyncMessageBuffer, *arguments: Any, **named: Any) -> None:
    _create(buffer, *arguments, **named)
    buffer.message_event = Wakeful()


def install() -> None:
    """Patch all message buffers created from now on; idempotent."""
    AsyncMessageBuffer.__init__ = _wakeful  # type: ignore[assignment, method-assign]
