"""Interrupts that cannot be lost: Python drops an exception raised within a callback of the compiler or a finaliser.

The signal is recorded separately and raised again where the runner polls for cancellation. What the interrupted command
leaves behind is the message of the exception, which `clearance.cli.invoke` prints. Start reading at `explained`.
"""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from campaigns.claims.numbers import count

if TYPE_CHECKING:
    from campaigns import Campaign
    from worker.running.runs.store import MemoryStore


@contextmanager
def deferred(cancelled: Callable[[], bool], *also: signal.Signals) -> Iterator[Callable[[], bool]]:
    """Yields `cancelled`, which now raises `KeyboardInterrupt` after SIGINT and `also`; for the main thread."""
    came = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal came
        came = True
        signal.default_int_handler(number, frame)

    def stopped() -> bool:
        if came:
            raise KeyboardInterrupt
        return cancelled()

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGINT, *also)}
    try:
        yield stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class InterruptedRun(KeyboardInterrupt):
    """An interrupt of a run in memory; the message states what is lost and how to continue.

    lowest: the lowest value that it had found; None if there is none."""

    def __init__(self, lost: str, campaign: Campaign, lowest: float | None) -> None:
        super().__init__(lost)
        self.campaign, self.lowest = campaign, lowest


def lowest(store: MemoryStore) -> float | None:
    """The lowest value in it; None if there is none."""
    chunks = [columns for chunks in store.chunks.values() for columns in chunks]
    return min(filter(math.isfinite, (float(value) for columns in chunks for value in columns.ranked())), default=None)


@contextmanager
def explained(store: MemoryStore, campaign: Campaign) -> Iterator[None]:
    """An interrupt becomes `InterruptedRun`."""
    before = _completed(store)
    try:
        yield
    except KeyboardInterrupt:
        made = _completed(store) - before
        were = "evaluation was completed; it is" if made == 1 else "evaluations were completed; they are"
        raise InterruptedRun(
            f"{count(made)} {were} not stored, because "
            "`clearance run` stores a run when it ends, so start it again. A run that is submitted to a service "
            "(`clearance submit`) resumes after an interruption",
            campaign,
            lowest(store),
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
