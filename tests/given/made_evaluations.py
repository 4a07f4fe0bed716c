"""Counts what a system evaluates, whoever asks for it and whether it is stored."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from campaigns.asked import allowance
from worker.engine.systems.closed_loop.system import ClosedLoop


@contextmanager
def flights() -> Iterator[Counter[str]]:
    """The flights of closed loops, by what asked for them: a confirmed case is three."""
    made: Counter[str] = Counter()
    of = {"evaluate": (0, 1), "confirm": (0, allowance.CASE), "compare": (0, 1), "beyond": (1, 1)}

    def counted(name: str) -> Any:
        plain, (place, each) = getattr(ClosedLoop, name), of.get(name, (None, 1))

        def call(self: ClosedLoop, *given: Any) -> Any:
            made[name] += each * (1 if place is None else len(given[place]))
            return plain(self, *given)

        return call

    with pytest.MonkeyPatch.context() as patched:
        for name in (*of, "trace", "encounter"):
            patched.setattr(ClosedLoop, name, counted(name))
        yield made


@contextmanager
def requests(system: Any) -> Iterator[list[int]]:
    """How many requests the slots of a simulator got, the one number of the list."""
    made, kind = [0], type(system)
    plain = kind._opened

    class Counting:
        """The slots, and how many requests they got."""

        def __init__(self, pool: Any) -> None:
            self.pool = pool

        def __getattr__(self, name: str) -> Any:
            return getattr(self.pool, name)

        def submit(self, request: Any) -> Any:
            made[0] += 1
            return self.pool.submit(request)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(kind, "_opened", lambda self: Counting(plain(self)))
        yield made
