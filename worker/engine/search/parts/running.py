"""A search among several that share a budget: what it has used and found, and whether it makes progress."""

from __future__ import annotations

import numpy as np

from worker.engine.search.base import Batch, Floats, Parallel, Space
from worker.engine.search.parts.turns import Member

FAILING = 0.1
"""Fraction of the evaluations of MLSL or the first descent that may fail: local searches end or crawl where others go
on."""


class Running(Member):
    """A running search: whether it stays apart, and what it has found."""

    def __init__(self, name: str, search: Parallel | None, space: Space, apart: bool = False) -> None:
        super().__init__(name, space.dimension, search)
        self.apart = apart
        self.stale = 0
        """Evaluations since its last improvement."""
        self.failed = 0
        self.credit = 0.0
        self.begun = False

    def begin(self, search: Parallel) -> None:
        """Run this search from now on."""
        self.search, self.begun = search, False

    @property
    def failing(self) -> bool:
        """Whether more of its evaluations fail than a local search can do with."""
        return self.failed > FAILING * self.used

    def ready(self) -> bool:
        """Whether it requests points."""
        if not self.begun:
            self.begun = True
            return self.advance(None)
        return self.search is not None

    def tell(self, batch: Batch, values: Floats) -> None:
        """Pass the values of the points that it requested."""
        self.used += len(values)
        self.failed += int(np.count_nonzero(np.isinf(values)))
        lowest = float(values.min())
        self.stale = 0 if lowest < self.lowest else self.stale + len(values)
        self.lowest = min(self.lowest, lowest)
        self.advance(batch)
