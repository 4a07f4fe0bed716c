"""Ctrl-C that cannot be lost: Python drops an exception raised within a callback of the compiler or a finaliser.

The signal is recorded separately and raised again where the runner polls for cancellation.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def deferred(cancelled: Callable[[], bool]) -> Iterator[Callable[[], bool]]:
    """Yields `cancelled`, which now raises `KeyboardInterrupt` after SIGINT; for the main thread."""
    came = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal came
        came = True
        signal.default_int_handler(number, frame)

    def asked() -> bool:
        if came:
            raise KeyboardInterrupt
        return cancelled()

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield asked
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def terminated() -> Iterator[None]:
    """SIGTERM, as CI services send it, interrupts as Ctrl-C does; for the main thread."""

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
