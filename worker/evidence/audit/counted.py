"""A sample of which only the lowest flights are stored: what its blocks of counts show, and whether they fit together.

Nothing is flown: the counts, sums and digests of the blocks are taken as costs are. What follows from them is made
again here, by a program of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from campaigns.claims.spans import Spans
from campaigns.claims.stages import sample as templates
from campaigns.results.base import OK
from campaigns.results.sample import Beside, Blocks, Histogram
from worker.evidence.audit import draw, limits
from worker.evidence.audit.binomial import upper_bound
from worker.evidence.audit.parts import Counts, made, read

LOWEST, STEPS, PARTS = 100, 400, 40
"""Points of a distribution function: the lowest values, and others; bins of a histogram that is shown, at most."""
KEPT, FAILURES, FIRST, BINS = 1000, 1000, 1024, 1000
"""Of a sample of which only a part is stored: its lowest flights, those without a result, its first draws, and the bins
of its histogram."""
STREAM = 2**24
"""Its random stream."""


def stored(blocks: Any) -> Blocks:
    """The blocks of counts that a result has."""
    return read(Blocks, blocks, beside=read(Beside, blocks["beside"]))


def ended(blocks: Blocks) -> Counts:
    """The numbers of its evaluations by status."""
    return Counts(sum(blocks.draws), sum(blocks.failed), sum(blocks.excluded))


def beside(blocks: Blocks, violating: int, status: Any) -> Beside:
    """The numbers of those that are not stored; of the stored ones, how many violate, and their status (k,)."""
    total, lost = ended(blocks), int(np.count_nonzero(status != OK))
    rest, failed = total.evaluations - len(status), total.failed - lost
    violating = sum(blocks.violations) - total.failed - violating
    return made(Beside, evaluations=rest, failed=failed, excluded=total.excluded, violating=violating)


def statement(blocks: Blocks, kept: int) -> Spans:
    """What is stored of it."""
    return templates.counted(sum(blocks.draws), len(blocks.draws), kept)


def block(requested: int) -> int:
    """Draws of a block of such a sample: the smallest power of two of which 1024 blocks suffice."""
    size = 1
    while size * 1024 < requested:
        size *= 2
    return size


def early(
    blocks: Blocks, requested: int, most: float, confidence: float, by_size: bool = True
) -> tuple[int, int | None]:
    """How many of the requested samples may violate for a bound of at most `most`, -1 if none; and of a sample that
    ended because more do, the samples before its last block; by_size: not of one that is whole with that block."""
    near, about = requested * most, 10.0 * (1.0 + math.sqrt(max(requested * most, 0.0)))
    allowed, beyond = max(-1, math.floor(near - about)), min(requested, math.ceil(near + about))
    if allowed >= 0 and upper_bound(allowed, requested, confidence) > most:
        allowed = -1
    while beyond - allowed > 1:
        middle = (allowed + beyond) // 2
        fits = upper_bound(middle, requested, confidence) <= most
        allowed, beyond = (middle, beyond) if fits else (allowed, middle)
    violations, total = blocks.violations, ended(blocks)
    drawn = total.evaluations
    whole = drawn - total.excluded >= requested or drawn >= limits.draws(requested, drawn)
    if allowed < 0 or (whole and by_size) or not sum(violations[:-1]) <= allowed < sum(violations):
        return allowed, None
    return allowed, total.evaluations - total.excluded - (blocks.draws[-1] - blocks.excluded[-1])


def scale(costs: list[float], threshold: float) -> tuple[float, float]:
    """Start and width of the bins, by the costs of the stages before: their range and a quarter more at both ends."""
    low, high = min(costs, default=threshold), max(costs, default=threshold)
    span = high - low or abs(threshold) or 1.0
    return low - 0.25 * span, 1.5 * span / BINS


def edges(blocks: Blocks) -> Any:
    """Of the bins, those below the first and above the last are open."""
    return blocks.low + blocks.width * np.arange(BINS + 1)


def through(blocks: Blocks) -> Any:
    """How many costs are in each bin and below it (BINS + 2,)."""
    bins = np.zeros(BINS + 2, dtype=np.int64)
    bins[blocks.places] = blocks.counts
    return np.cumsum(bins)


def moments(blocks: Blocks) -> tuple[float, float] | None:
    """Mean and standard deviation; None of a single cost."""
    known = int(through(blocks)[-1])
    if known < 2:
        return None
    mean = sum(blocks.totals) / known
    spread = max(0.0, sum(blocks.squares) - known * mean * mean)
    return blocks.low + mean, math.sqrt(spread / (known - 1))


def histogram(blocks: Blocks) -> Histogram:
    """Neighbouring bins as one, at most forty."""
    filled = sorted(place for place, count in zip(blocks.places, blocks.counts, strict=True) if count)
    if not filled:
        return made(Histogram, edges=[], counts=[])
    first, last = filled[0], filled[-1] + 1
    starts = list(range(first, last, math.ceil((last - first) / PARTS)))
    below = np.concatenate([[0], through(blocks)])
    ends = [min(b for b in blocks.lowest if b is not None), *edges(blocks).tolist(), blocks.highest]
    counts = [int(below[b] - below[a]) for a, b in zip(starts, [*starts[1:], last], strict=True)]
    return made(Histogram, edges=[ends[place] for place in (*starts, last)], counts=counts)


def value(blocks: Blocks, kept: Any, rank: int) -> float | None:
    """What the cost of this rank, counted from 1 with the failed ones as the lowest, is at least; None if of no cost,
    or of none that is known."""
    rank -= sum(blocks.failed)
    if rank <= 0:
        return None
    if rank <= len(kept):
        return float(kept[rank - 1])
    place = int(np.searchsorted(through(blocks), rank))
    known = [float(kept[-1])] if len(kept) else []
    return max(known + ([float(edges(blocks)[place - 1])] if place else []), default=None)


def fitting(blocks: Blocks, requested: int, flights: Any, costs: Any, status: Any, threshold: float) -> tuple[int, int]:
    """The number of blocks, and of those whose place, size, and lowest flights are what they must be; the kept flights
    in the order of their indices: indices, first costs and status (k,)."""
    rest, number = blocks.beside, len(blocks.draws)
    if not 0 <= rest.timeouts <= rest.failed or not 0 <= rest.flaky <= rest.evaluations:
        return number, 0
    if sum(rest.exclusions.values()) != rest.excluded or min(rest.exclusions.values(), default=1) <= 0:
        return number, 0
    counts = (blocks.draws, blocks.violations, blocks.failed, blocks.excluded)
    if any(len(one) != number for one in (*counts, blocks.lowest, blocks.digests, blocks.totals, blocks.squares)):
        return number, 0
    total = ended(blocks)
    known = total.evaluations - total.failed - total.excluded
    if sum(blocks.counts) != known:
        return number, 0
    lowest, highest = min(flights, default=0), max(flights, default=0)
    if not np.all(np.diff(flights) > 0) or not 0 <= lowest <= highest < sum(blocks.draws):
        return number, 0
    kept = Kept(flights, costs, status)
    if not kept.complete(known, total.failed):
        return number, 0
    first, fits = 0, 0
    for size, block in zip(_sizes(requested, blocks), map(Block, *counts, blocks.lowest), strict=False):
        if block.draws != size:
            break
        fits += kept.fits(block, first, threshold)
        first += size
    whole = first == sum(blocks.draws) and kept.binned(blocks, threshold) and kept.begun(blocks)
    return number, fits if whole else 0


class Block(NamedTuple):
    """The numbers of one block, and the lowest of its costs."""

    draws: int
    violations: int
    failed: int
    excluded: int
    lowest: float | None


class Kept(NamedTuple):
    """The stored flights in the order of their indices: indices, first costs and status (k,)."""

    flights: Any
    costs: Any
    status: Any

    @property
    def last(self) -> float:
        """Every flight below this cost is stored."""
        ok = np.sort(self.costs[self.status == OK])
        return math.inf if len(ok) < KEPT else float(ok[KEPT - 1])

    @property
    def end(self) -> float:
        """Every flight without a result up to this index is stored."""
        lost = self.flights[self.status != OK]
        return math.inf if len(lost) < FAILURES else float(lost[FAILURES - 1])

    def complete(self, known: int, failed: int) -> bool:
        """Whether so many are stored, and no others than the lowest, the first without a result and the first draws."""
        ok = self.status == OK
        stored = int(ok.sum()) >= min(KEPT, known) and int((~ok).sum()) >= min(FAILURES, failed)
        called_for = np.where(ok, self.costs <= self.last, self.flights <= self.end) | (self.flights < FIRST)
        return bool(stored and called_for.all())

    def begun(self, blocks: Blocks) -> bool:
        """Whether of the first draws all are stored that the blocks do not count as excluded."""
        starts = np.cumsum([0, *blocks.draws[:-1]])
        excluded = sum(n for n, start in zip(blocks.excluded, starts, strict=True) if start < FIRST)
        return bool(np.count_nonzero(self.flights < FIRST) >= min(FIRST, sum(blocks.draws)) - excluded)

    def binned(self, blocks: Blocks, threshold: float) -> bool:
        """Whether the bins are those of the stored flights as far as all are stored, and fit the other counts."""
        places, counts, ends = np.array(blocks.places), np.array(blocks.counts), edges(blocks)
        if len(places) != len(counts) or np.any(np.diff(places) <= 0) or np.any(counts <= 0):
            return False
        if not len(places):
            return True
        if places[0] < 0 or places[-1] > BINS + 1:
            return False
        ok, below = np.sort(self.costs[self.status == OK]), through(blocks)
        lowest, highest = np.array([min(b for b in blocks.lowest if b is not None), blocks.highest])
        if [places[0], places[-1]] != np.searchsorted(ends, [lowest, highest]).tolist() or highest < ok[-1]:
            return False
        stored = np.searchsorted(ok, ends, side="right")  # costs at or below each edge
        every = ends < self.last
        low = np.all(below[:-1][every] == stored[every]) and np.all(below[:-1] >= stored)
        violating, at = sum(blocks.violations) - sum(blocks.failed), int(np.searchsorted(ends, threshold))
        least = 0 if at == 0 else int(below[at - 1])
        return bool(low and least <= violating <= int(below[at]))

    def fits(self, block: Block, first: int, threshold: float) -> bool:
        """Whether the counts of one block are those of its stored flights, as far as these say."""
        inside = (self.flights >= first) & (self.flights < first + block.draws)
        ok, lost = self.costs[inside & (self.status == OK)], int(np.count_nonzero(inside & (self.status != OK)))
        evaluated, lowest = block.draws - block.excluded, block.lowest
        counts = 0 <= block.failed <= block.violations <= evaluated <= block.draws and lost <= block.failed
        counts &= lost == block.failed or first + block.draws > self.end
        counts &= int(inside.sum()) == evaluated or first + block.draws > FIRST
        seen = min(ok.tolist(), default=math.inf)  # of the first draws all are stored, of others the lowest of all
        low = seen == math.inf if lowest is None else lowest == seen or self.last <= lowest <= seen
        below = int(np.count_nonzero(ok <= threshold)) + block.failed
        every = below == block.violations or (below < block.violations and threshold >= self.last)
        return bool(counts and low and every)


def _sizes(requested: int, blocks: Blocks) -> Iterator[int]:
    """The draws of each block: the requested ones, then as many as were excluded of those before, at most twice."""
    each = block(requested)
    done, until, row = 0, requested, 0
    while True:
        while done < until:
            size = min(each, until - done)
            yield size
            done, row = done + size, row + 1
        missing = requested - (done - sum(blocks.excluded[:row]))
        until = min(until + max(missing, 0), limits.DRAWS * requested)
        if done >= until:
            return


def redrawn(campaign: Any, bounds: draw.Bounds, seed: int, flights: Any) -> Any:
    """The points (k, n) of these draws of the sample."""
    size = len(bounds)
    key = np.random.SeedSequence(seed, spawn_key=(STREAM,)).generate_state(2, np.uint64)
    steps = math.ceil(size / 4)
    numbers = [
        np.random.Generator(np.random.Philox(key=key, counter=int(index) * steps)).random(size) for index in flights
    ]
    return draw.distributed(campaign, bounds).quantile(np.array(numbers).reshape(-1, size))
