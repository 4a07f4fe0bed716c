"""The costs of a sample, however they are kept: all of them in order, or counted with the lowest ones.

What a counted sample cannot tell exactly, it bounds on the side of caution: a value is that of the low edge of its bin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from campaigns.results.sample import Histogram
from campaigns.stored.blocks import Counted, Whole
from worker.engine.systems.base import Floats

STEPS = 400
"""Points of the distribution function in a chart."""
PARTS = 5, 40
"""The fewest and the most bins of a histogram that is shown."""


@dataclass(frozen=True)
class Ordered:
    """All costs, sorted; ranks count from 1, the lowest."""

    costs: Floats

    @property
    def known(self) -> int:
        """How many evaluations have a cost."""
        return len(self.costs)

    @property
    def lowest(self) -> float | None:
        """The lowest cost; None if there is none."""
        return float(self.costs[0]) if len(self.costs) else None

    @property
    def moments(self) -> tuple[float | None, float | None]:
        """Mean and standard deviation; None where there are too few."""
        mean = float(self.costs.mean()) if len(self.costs) else None
        return mean, float(self.costs.std(ddof=1)) if len(self.costs) > 1 else None

    def value(self, rank: int) -> float | None:
        """What the cost of this rank is at least; None if nothing bounds it."""
        return float(self.costs[rank - 1])

    def histogram(self) -> Histogram:
        size = len(self.costs)
        low, high = (float(self.costs[0]), float(self.costs[-1])) if size else (0.0, 0.0)
        if high - low == math.inf:
            return Histogram(edges=[low, high], counts=[size])
        try:
            counts, edges = np.histogram(self.costs, bins=min(PARTS[1], max(PARTS[0], int(np.sqrt(size)))))
        except ValueError:  # they differ by rounding, which no bin can divide
            around = max(0.5, 4 * float(np.spacing(abs(high))))
            return Histogram(edges=[low - around, high + around], counts=[size])
        return Histogram(edges=edges.tolist(), counts=counts.tolist())

    def curve(self) -> tuple[list[float], list[int]]:
        """Points of the distribution function: distinct values, and how many costs are at or below each."""
        # The lowest values, and evenly spaced ones of the rest.
        size = len(self.costs)
        lowest = np.arange(min(size, STEPS // 4))
        chosen = np.union1d(lowest, np.linspace(0, size - 1, min(size, STEPS)).astype(np.int64))
        values = np.unique(self.costs[chosen])
        return values.tolist(), np.searchsorted(self.costs, values, side="right").tolist()


@dataclass(frozen=True)
class Binned:
    """As `Ordered`: the lowest costs, and how many are in each bin of a scale."""

    counted: Counted

    @cached_property
    def _lowest(self) -> Floats:
        return self.counted.kept.lowest

    @property
    def _edges(self) -> Floats:
        return self.counted.scale.edges

    @cached_property
    def _through(self) -> Whole:
        """How many costs are in each bin and those below it."""
        return np.cumsum(self.counted.bins)

    @property
    def known(self) -> int:
        return self.counted.evaluated - self.counted.failed

    @property
    def lowest(self) -> float | None:
        return self.counted.lowest

    @property
    def moments(self) -> tuple[float | None, float | None]:
        return self.counted.moments or (self.lowest, None)

    def value(self, rank: int) -> float | None:
        if rank <= len(self._lowest):
            return float(self._lowest[rank - 1])
        place, least = int(np.searchsorted(self._through, rank)), self._lowest[-1:].tolist()
        return max([*least, *self._edges[max(place - 1, 0) : place].tolist()], default=None)

    def histogram(self) -> Histogram:
        bins = self.counted.bins
        filled = np.flatnonzero(bins)
        if not len(filled):
            return Histogram(edges=[], counts=[])
        first, last = int(filled[0]), int(filled[-1]) + 1
        starts = np.arange(first, last, -(-(last - first) // PARTS[1]))
        counts = np.add.reduceat(bins[first:last], starts - first)
        # The first and the last bin of the scale are open: they end at the lowest and the highest cost.
        ends = np.array([self.lowest, *self._edges, self.counted.highest], dtype=np.float64)
        return Histogram(edges=[*ends[starts].tolist(), float(ends[last])], counts=counts.tolist())

    def curve(self) -> tuple[list[float], list[int]]:
        if not self.known:
            return [], []
        kept = self._lowest
        lowest = np.unique(kept[: STEPS // 4])
        if len(kept) < self.known:  # how many costs are equal to the last one that is kept is not known
            lowest = lowest[lowest < kept[-1]]
        ranks = np.searchsorted(kept, lowest, side="right")
        places = np.flatnonzero((self.counted.bins > 0) & (self._through > max(ranks, default=0)))[:-1]
        places = places[:: -(-max(len(places), 1) // STEPS)]
        values = [*lowest.tolist(), *self._edges[places].tolist()]
        if not values and self.counted.highest is not None:
            return [self.counted.highest], [self.known]
        return values, [*ranks.tolist(), *self._through[places].tolist()]


Shape = Ordered | Binned
"""The costs of the evaluations that have one."""
