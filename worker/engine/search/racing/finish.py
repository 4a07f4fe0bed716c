"""The final phase of contrast racing: merges incumbents without a barrier between them and polishes the best.

Hill-valley test: Ursem, Multinational evolutionary algorithms (CEC 1999).
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Protocol

import numpy as np

from worker.engine.search.base import Batch, Floats, Minimum, Space
from worker.engine.search.racing.pool import NEAR, Pool
from worker.engine.search.racing.samples import Samples
from worker.engine.search.racing.state import COMPASS, Ints

CANDIDATES, VALLEYS, COMPARED = 30, 12, 3
"""Number of best incumbents to merge; of valleys to store; of nearest valleys that each is compared with."""
CAP = 0.04
"""Fraction of the budget that merging may use."""
LAST = 1_000_000
"""The rung of polished searchers, above all others."""


class Options(Protocol):
    """The options of the final phase."""

    @property
    def first(self) -> int: ...
    @property
    def hill(self) -> float: ...
    @property
    def polished(self) -> int: ...


class Finish:
    """The valleys found, each by the index of the searcher at its lowest point."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool
        self.valleys: list[int] = []
        self.polished: list[int] = []

    def run(self, used: int, total: int, samples: Samples, options: Options) -> Generator[Floats, Batch, int]:
        """Merge, then polish until `total` evaluations are used; returns the number used in this phase."""
        if self.pool.count == 0:
            return 0
        median = float(np.median(samples.value[: samples.count]))
        scale = options.hill * max(median - float(self.pool.cost.min()), 0.0)
        spent = yield from self._merge(int(CAP * total), scale)
        spent += yield from self._polish(total - used - spent, options)
        return spent

    def _merge(self, cap: int, scale: float) -> Generator[Floats, Batch, int]:
        pool, spent = self.pool, 0
        self.valleys = []
        for c in np.argsort(pool.cost, kind="stable")[:CANDIDATES]:
            if len(self.valleys) == VALLEYS or spent >= cap:
                break
            distance = np.abs(pool.best[self.valleys] - pool.best[c]).max(axis=1)
            if not (distance < NEAR).any():
                near = np.array(self.valleys)[np.argsort(distance, kind="stable")[:COMPARED]]
                same, points = yield from self._same(int(c), near, scale)
                spent += points
                if same:
                    continue
                self.valleys.append(int(c))
        return spent

    def _same(self, c: int, valleys: Ints, scale: float) -> Generator[Floats, Batch, tuple[bool, int]]:
        """Whether c has no barrier to one of these valleys: tests the midpoint, and if it is low the quarter points."""
        pool, spent = self.pool, 0
        for fractions in ((0.5,), (0.25, 0.75)):
            if len(valleys) == 0:
                return False, spent
            a, b = pool.best[valleys], pool.best[c]
            points = np.concatenate([a + fraction * (b - a) for fraction in fractions])
            batch = yield points
            spent += len(points)
            values = batch.ranked().reshape(len(fractions), len(valleys))
            limit = np.maximum(pool.cost[valleys], pool.cost[c]) + scale
            valleys = valleys[(values <= limit).all(axis=0)]
        return len(valleys) > 0, spent

    def _polish(self, room: int, options: Options) -> Generator[Floats, Batch, int]:
        """Polish the best valleys, those with the fewest evaluations first."""
        pool, spent = self.pool, 0
        n = pool.best.shape[1]
        self.polished = [self._polisher(t) for t in self.valleys[: options.polished]]
        self.valleys[: len(self.polished)] = self.polished
        rows = np.array(self.polished, dtype=np.int64)
        had = np.minimum(pool.state.evaluations[rows], 5 * options.first * n)
        began = pool.state.evaluations[rows].copy()
        while spent < room:
            count = had + pool.state.evaluations[rows] - began
            some = rows[count < count.min() + 2 * n]
            points = pool.requested(some)
            batch = yield points.copy()
            spent += len(points)
            pool.tell(some, batch.ranked())
        return spent

    def _polisher(self, t: int) -> int:
        """The searcher that polishes t: a new one, unless t is one itself, which inherits its evaluation count."""
        pool = self.pool
        if pool.rung[t] == LAST:
            return t
        made = pool.begin(pool.best[t].copy(), float(pool.cost[t]), pool.starts[t], COMPASS, 0.05, 0.02, LAST)
        pool.state.evaluations[made] = pool.state.evaluations[t]
        return made

    def report(self, space: Space) -> None:
        """Report the valleys as minima; if none were merged, the best incumbents that are not close to each other."""
        pool = self.pool
        merged = bool(self.valleys)
        for t in self.valleys or pool.apart(VALLEYS):
            if t in self.polished:
                text = "polished to the end of the search"
            else:
                text = "a separate valley, not polished" if merged else "the search ended before it was polished"
            evaluations = int(pool.state.evaluations[t])
            space.report(Minimum(pool.best[t].copy(), float(pool.cost[t]), pool.starts[t], max(evaluations, 1), text))
