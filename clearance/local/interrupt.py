"""Interrupts that cannot be lost: Python drops an exception raised within a callback of the compiler or a finaliser.

The signal is recorded separately and raised again where the runner polls for cancellation. What the interrupted command
leaves behind is the message of the exception, which `clearance.cli.invoke` prints. Start reading at `explained`.
"""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
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
    """The lowest value in it, whether its evaluation is stored in order, waits for an earlier one or is only counted;
    None if there is none."""
    ahead = (waiting.columns for some in store.waiting.values() for waiting in some)
    parts = [*chain.from_iterable(store.chunks.values()), *ahead]
    counted = (block.lowest for block in chain.from_iterable(store.counted.values()) if block.lowest is not None)
    values = chain((float(value) for columns in parts for value in columns.ranked()), counted)
    return min(filter(math.isfinite, values), default=None)


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
    """How many evaluations it contains, also those that ended before an earlier one of their stage or are counted."""
    return sum(_completed_at(store, at) for at in range(len(store.stages)))


def _completed_at(store: MemoryStore, position: int) -> int:
    if blocks := store.blocks(position):  # what is stored of such a stage is counted in them
        return sum(block.draws for block in blocks)
    columns, ahead = store.evaluations(position), store.ahead(position)
    return (0 if columns is None else len(columns.status)) + (0 if ahead is None else len(ahead.indices))


@contextmanager
def terminated() -> Iterator[None]:
    """SIGTERM, as CI services send it, interrupts as Ctrl-C does; for the main thread."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
