"""How much a descent improved lately."""

from __future__ import annotations

import math


class Progress:
    """The lowest cost of a descent by the number of its evaluations; infinite where there is none."""

    def __init__(self, window: int) -> None:
        self._window = window
        self._history = [(0, math.inf)]

    def add(self, evaluations: int, cost: float) -> None:
        """The lowest cost after so many evaluations, more than before."""
        self._history.append((evaluations, cost))

    @property
    def cost(self) -> float:
        """The lowest cost."""
        return self._history[-1][1]

    @property
    def gain(self) -> float:
        """The improvement over the last evaluations, as many as the window has; infinite before there are so many."""
        evaluations, cost = self._history[-1]
        before = next(c for e, c in reversed(self._history) if e <= max(evaluations - self._window, 0))
        return before - cost if math.isfinite(before) else math.inf
