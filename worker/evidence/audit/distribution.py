"""The distribution function of a sample and its band, again: by the rules of today, or of the version of the record."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from campaigns.results.sample import Blocks, Distribution
from worker.evidence.audit.counted import LOWEST, STEPS, edges, through
from worker.evidence.audit.parts import made


class Drawn(NamedTuple):
    """What the function of a sample rests on besides its costs.

    stated: the one of the record, as JSON; moved: the probability that a draw was moved inside the bounds, by which its
    band is wider; today: whether it must follow from the rules of today, by which equal values are one, too.
    """

    stated: Any
    confidence: float
    moved: float
    today: bool

    def of_costs(self, costs: Any, failed: int) -> Distribution:
        """Of sorted costs, of which each failed one is the lowest."""
        return self._followed(lambda moved, ties: _of_costs(costs, failed, self.confidence, moved, ties))

    def of_blocks(self, blocks: Blocks, kept: Any) -> Distribution:
        """Of a counted sample, the lowest costs of which are kept."""
        return self._followed(lambda moved, ties: _of_blocks(blocks, kept, self.confidence, moved, ties))

    def _followed(self, function: Callable[[float, bool], Distribution]) -> Distribution:
        """By the rules of today, which a record of any version may follow, else by those of its own."""
        found = function(self.moved, True)
        if self.today or all(getattr(found, name) == value for name, value in self.stated.items()):
            return found
        return function(0.0, False)


def _of_blocks(blocks: Blocks, kept: Any, confidence: float, moved: float, ties: bool) -> Distribution:
    """The lowest values one by one, and the upper edges of bins; ties: whether equal values are one."""
    failed, below = sum(blocks.failed), through(blocks)
    every = int(below[-1]) + failed
    values, ranks = kept[:LOWEST].tolist(), list(range(1, min(len(kept), LOWEST) + 1))
    if ties:
        equal, last = Counter(kept.tolist()), math.inf if len(kept) == below[-1] else kept[-1]
        values = sorted(value for value in set(values) if value < last)
        ranks = list(accumulate(equal[value] for value in values))
    places = [p for p in sorted(blocks.places) if below[p] > max(ranks, default=0)]
    places = places[:-1]
    places = places[:: max(1, math.ceil(len(places) / STEPS))]
    values, ranks = values + edges(blocks)[places].tolist(), ranks + [int(below[p]) for p in places]
    if ties and below[-1] and not values:
        values, ranks = [blocks.highest], [int(below[-1])]
    shares = [(failed + rank) / max(every, 1) for rank in ranks]
    return made(Distribution, values=values, shares=shares, band=_band(every, confidence, moved))


def _of_costs(costs: Any, failed: int, confidence: float, moved: float, ties: bool) -> Distribution:
    """The empirical distribution function of a sample's sorted costs, of which each failed one is the lowest; ties:
    whether equal values are one."""
    size, every = len(costs), failed + len(costs)
    even = np.linspace(0, size - 1, min(size, STEPS)).astype(np.int64)
    chosen = np.union1d(np.arange(min(size, LOWEST)), even)
    values, ranks = costs[chosen], chosen + 1
    if ties:
        equal, times = np.unique(costs, return_counts=True)
        listed = np.isin(equal, values)
        values, ranks = equal[listed], np.cumsum(times)[listed]
    shares = ((failed + ranks) / max(every, 1)).tolist()
    return made(Distribution, values=values.tolist(), shares=shares, band=_band(every, confidence, moved))


def _band(every: int, confidence: float, moved: float) -> float:
    """Half the width of the band of Massart 1990; wider by the probability that a draw was moved inside the bounds."""
    return min(1.0, math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * every)) + moved) if every else 1.0
