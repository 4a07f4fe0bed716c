"""Flies an independent sample of any size, of which only blocks are stored: their counts and the lowest flights.

Every point follows from the seed and its index (`campaigns.results.draws.uniform`), so that any flight can be made
again, a stage that was interrupted goes on with the blocks it lacks, to the same bits, and others fly blocks of it. How
many draws follow depends on how many were excluded, never on what came out, so that the sample stays independent. One
that ends early does so when more violate than may: a bound from the violations, and the samples before the last of
them, still holds, because it is no lower than that of inverse sampling (Haldane, Biometrika 33, 1945), which counts one
sample less.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from campaigns.limits import DRAWS
from campaigns.results.draws import of_indices, uniform
from campaigns.stored.blocks import Block, Counted, Kept, Scale, counted, size
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Batch
from worker.engine.stages.parts.context import Cancelled, Context, Tally
from worker.engine.systems import optional
from worker.engine.systems.base import Floats, Seeds, System, slots

STREAM = 2**24
"""Index of the random stream; that of a sample which is stored whole is another."""
SAVED = 1.0
"""Time between two writes [s]."""
LANES, SLOTS = 16, 4
"""A call has so many blocks of lanes at least, or so many evaluations for each slot, however slow they are."""


class Draws(NamedTuple):
    """Consecutive draws of a sample."""

    first: int
    number: int


@dataclass(frozen=True)
class Drawing:
    """The draws of one sample by their index."""

    problem: Problem
    seed: int

    def points(self, draws: Draws) -> Floats:
        """Their points (number, n)."""
        return self.problem.quantile(uniform(self.seed, STREAM, *draws, self.problem.dimension))

    def seeds(self, draws: Draws) -> Seeds | None:
        """The noise that each draws; None without any."""
        if not self.problem.realisations.random:
            return None
        return of_indices(self.seed, np.arange(draws.first, draws.first + draws.number))


def planned(samples: int, blocks: Mapping[int, Block], allowed: int | None = None) -> Iterator[Draws]:
    """The blocks of a sample as far as those that are flown decide: all draws, then those in place of excluded ones.

    allowed: more violations than these end it with their block; None if it is always whole.
    """
    each, first, most, violations = size(samples), 0, DRAWS * samples, 0
    until = samples
    while first < until:
        while first < until:
            draws = Draws(first, min(each, until - first))
            yield draws
            if allowed is not None:
                violations += blocks[first].violations if first in blocks else allowed + 1
                if violations > allowed:
                    return
            first += draws.number
        flown = [block for at, block in blocks.items() if at < until]
        if sum(block.draws for block in flown) < until:
            return
        until = min(until + max(samples - sum(block.evaluated for block in flown), 0), most)


@dataclass
class Counting:
    """One sample that is flown and counted; `blocks` by their first draw."""

    context: Context
    position: int
    samples: int
    drawing: Drawing
    single: System | None
    """What evaluates in place of the system: one call of a noisy simulator."""
    scale: Scale
    allowed: int | None = None
    """How many may violate before it ends early; None if it never does."""
    blocks: dict[int, Block] = field(default_factory=dict)
    tally: Tally = field(default_factory=Tally)
    lowest: Kept | None = None
    """Of all blocks so far: what is not among them is not stored with a block."""

    def fly(self) -> Counted:
        """The whole sample, of which others may fly blocks meanwhile; raises `Cancelled`."""
        self._fly(others=True)
        return Counted.of([*self.blocks.values()], self.scale)

    def assist(self) -> None:
        """Simulate blocks that no other worker has taken, until there are none; raises `Cancelled`."""
        try:
            self._fly(others=False)
        finally:
            self.context.store.take(self.position, [], 0, others=False)

    def _fly(self, others: bool) -> None:
        self._join()
        offset, began = self.tally.seconds, time.perf_counter()
        unsaved: list[Block] = []
        saved = began
        try:
            while missing := self._missing(others):
                if self.context.cancelled():
                    raise Cancelled
                unsaved += map(self._add, self._flown(missing, offset - began))
                if time.perf_counter() - saved > SAVED:
                    saved = self._save(unsaved)
                    self._join()
        finally:
            self._save(unsaved)

    def _join(self) -> None:
        """Add the blocks that others have stored."""
        for block in self.context.store.blocks(self.position, self.blocks.keys()):
            self._add(block)

    def _missing(self, others: bool) -> list[Draws]:
        """The next blocks to fly in one call, as many as take about the time between two writes.

        others: also those that others have taken, if there are no more; flown twice they are the same.
        """
        room = max(1, self._room() // size(self.samples))
        while True:
            known = len(self.blocks)
            left = {d.first: d for d in planned(self.samples, self.blocks, self.allowed) if d.first not in self.blocks}
            taken = self.context.store.take(self.position, [*left], room, others) if left else []
            if taken or not others:
                return [left[first] for first in taken]
            self._join()  # all that is left may be stored by now, and more draws may follow from that
            if len(self.blocks) == known:
                return []

    def _flown(self, missing: list[Draws], since: float) -> Iterator[Block]:
        """Blocks that need not be neighbours, evaluated in one call."""
        points = np.concatenate([self.drawing.points(draws) for draws in missing])
        drawn = [self.drawing.seeds(draws) for draws in missing]
        seeds = np.concatenate([own for own in drawn if own is not None]) if drawn[0] is not None else None
        batch, reasons = self._evaluated(points, seeds)
        ended = time.perf_counter()
        row = 0
        for draws in missing:
            rows = slice(row, row + draws.number)
            whys = {at - row: why for at, why in reasons.items() if row <= at < row + draws.number}
            threshold = self.context.problem.threshold
            yield counted(
                draws.first,
                points[rows],
                batch.costs[rows],
                batch.status[rows],
                whys,
                self.scale,
                threshold,
                since + ended,
            )
            row += draws.number

    def _evaluated(self, points: Floats, seeds: Seeds | None) -> tuple[Batch, dict[int, str]]:
        """Evaluate points in pieces that take about the time between two writes; raises `Cancelled` before one."""
        batches, reasons, done = [], dict[int, str](), 0
        while done < len(points):
            if self.context.cancelled():
                raise Cancelled
            piece = slice(done, done + self._room())
            batch, whys = self._piece(points[piece], None if seeds is None else seeds[piece])
            batches.append(batch)
            reasons |= {done + row: why for row, why in whys.items()}
            done += len(batch.status)
            self.context.store.beat()
        costs, status = zip(*batches, strict=True)
        return Batch(np.concatenate(costs), np.concatenate(status)), reasons

    def _piece(self, points: Floats, seeds: Seeds | None) -> tuple[Batch, Mapping[int, str]]:
        began = time.perf_counter()
        if self.single is not None:
            found = self.single.evaluate(self.context.problem.vectors(points))
        else:
            found = self.context.evaluate(points, *([] if seeds is None else [seeds]))
        self.context.problem.system.cost = max(time.perf_counter() - began, 1e-6) / len(points)
        return found

    def _room(self) -> int:
        """Evaluations in about half the time between two writes."""
        system = self.context.problem.system
        least = max(LANES * (optional.settings(system).lanes or 0), SLOTS * slots(system), 1)
        return least if system.cost is None else max(least, int(SAVED / system.cost / 2))

    def _add(self, block: Block) -> Block:
        """The block as it is stored."""
        self.lowest = block.kept if self.lowest is None else Kept.joined([self.lowest, block.kept])
        block = block.without(self.lowest.last)
        self.blocks[block.first] = block
        tally = self.tally
        tally.evaluations += block.draws
        tally.failed += block.failed
        tally.excluded += block.excluded
        tally.seconds = max(tally.seconds, block.seconds)
        if block.lowest is not None and (tally.best is None or block.lowest < tally.best):
            tally.best = block.lowest
        return block

    def _save(self, unsaved: list[Block]) -> float:
        if unsaved:
            blocks, unsaved[:] = [*unsaved], []  # even on error: the store may have written them before it raised
            self.context.store.count(self.position, blocks)
        self.context.progress(self.position, self.tally)
        return time.perf_counter()


def kept(sample: Counted) -> Columns:
    """The flights that are kept as evaluations of the stage, in the order of their draws."""
    found = sample.kept
    seconds = np.full(len(found.indices), max((block.seconds for block in sample.blocks), default=0.0))
    reasons = {row: found.reasons[i] for row, i in enumerate(found.indices.tolist()) if i in found.reasons}
    return Columns(found.points, found.costs, found.status, seconds, reasons)
