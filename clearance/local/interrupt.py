"""Ctrl-C that cannot be lost: Python drops an exception raised within a callback of the compiler or a finaliser.

The signal is recorded separately and raised again where the runner polls for cancellation. What the interrupted command
leaves behind is the message of the exception, which `clearance.cli.invoke` prints.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from campaigns.claims.numbers import count

if TYPE_CHECKING:
    from worker.running.runs.store import MemoryStore


@contextmanager
def deferred(cancelled: Callable[[], bool]) -> Iterator[Callable[[], bool]]:
    """Yields `cancelled`, which now raises `KeyboardInterrupt` after SIGINT; for the main thread."""
    came = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal came
        came = True
        signal.default_int_handler(number, frame)

    def stopped() -> bool:
        if came:
            raise KeyboardInterrupt
        return cancelled()

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield stopped
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def explained(store: MemoryStore) -> Iterator[None]:
    """An interrupt of a run in memory states what is lost and how to continue."""
    before = _completed(store)
    try:
        yield
    except KeyboardInterrupt:
        made = _completed(store) - before
        were = "evaluation was completed; it is" if made == 1 else "evaluations were completed; they are"
        raise KeyboardInterrupt(
            f"{count(made)} {were} not stored, because "
            "`clearance run` stores a run when it ends, so start it again. A run that is submitted to a service "
            "(`clearance submit`) resumes after an interruption"
        ) from None


def _completed(store: MemoryStore) -> int:
    """How many evaluations it contains, also those that ended before an earlier one of their stage."""
    columns = [store.evaluations(at) for at in range(len(store.stages))]
    ahead = [store.ahead(at) for at in range(len(store.stages))]
    return sum(len(c.status) for c in columns if c is not None) + sum(len(a.indices) for a in ahead if a is not None)


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
