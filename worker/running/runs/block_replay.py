"""Flies blocks of a sample again of which only a part is stored, from the seed and the indices of their draws alone.

What a block states must be what its flights show: the counts, the lowest cost and the sums; on a machine of the same
kind the digest over the bits of all costs, too. Bins and the highest cost are stated of all blocks together, and
compared where all of a sample are flown.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from campaigns.claims.numbers import count
from campaigns.results.sample import Blocks
from campaigns.stored.blocks import BINS, Block, Scale, counted
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.counting import Drawing, Draws
from worker.engine.systems.base import slotted
from worker.running.runs.replay import ELSEWHERE, Agreement, Recorded, UnknownCase

PIECE = 16_384
"""Flights in one call."""


@dataclass(frozen=True)
class Reflown:
    """A block that was flown again."""

    position: int
    first: int
    draws: int
    agreement: Agreement

    whole: bool = False
    """The bins and the highest cost of all of them."""

    @property
    def name(self) -> str:
        if self.whole:
            return f"the histogram of the sample of stage {self.position}"
        last = self.first + self.draws - 1
        return f"draws {count(self.first)} to {count(last)} of the sample of stage {self.position}"


def reflown(recorded: Recorded, problem: Problem, number: int) -> list[Reflown]:
    """So many blocks that the caller of the process could not know before, all of them if there are not so many; raises
    `UnknownCase` if the run has no such sample."""
    samples = _samples(recorded)
    if not samples:
        raise UnknownCase("it has no sample of which only a part is stored; name evaluations instead of blocks")
    every = [(at, row) for at, blocks in samples.items() for row in range(len(blocks.draws))]
    random = np.random.default_rng()  # not from a seed: what will be looked at cannot be prepared
    chosen = sorted(random.permutation(len(every))[:number].tolist())
    flown = {every[k]: _again(recorded, problem, samples[every[k][0]], every[k][1]) for k in chosen}
    found = [Reflown(at, now.first, now.draws, _agreement(samples[at], row, now)) for (at, row), now in flown.items()]
    for at, then in samples.items():
        mine = [now for (position, _), now in flown.items() if position == at]
        if len(mine) == len(then.draws):
            agreement: Agreement = "same bits" if _same_bins(then, mine) else "differs"
            found.append(Reflown(at, 0, sum(then.draws), agreement, whole=True))
    return found


def having(recorded: Recorded, draws: int) -> int:
    """The number of blocks that have so many draws; 0 of a run without such a sample."""
    largest = max((max(blocks.draws) for blocks in _samples(recorded).values()), default=0)
    return math.ceil(draws / largest) if largest else 0


def _samples(recorded: Recorded) -> dict[int, Blocks]:
    found = {at: result.counted for at, result in recorded.results.items() if result is not None}
    return {at: blocks for at, blocks in found.items() if blocks is not None}


def _again(recorded: Recorded, problem: Problem, then: Blocks, row: int) -> Block:
    draws = Draws(sum(then.draws[:row]), then.draws[row])
    drawing = Drawing(problem, recorded.sample_seed)
    noisy = recorded.measured is not None and not recorded.measured.identical
    system = slotted(problem.system).single() if noisy else problem.system
    points, seeds, reasons = drawing.points(draws), drawing.seeds(draws), dict[int, str]()
    costs, status = [], []
    for begin in range(0, draws.number, PIECE):
        piece = slice(begin, min(begin + PIECE, draws.number))
        batch, whys = system.evaluate(problem.vectors(points[piece]), None if seeds is None else seeds[piece])
        costs.append(batch.costs)
        status.append(batch.status)
        reasons |= {piece.start + at: why for at, why in whys.items()}
    scale = Scale(then.low, then.width)
    every = np.concatenate(costs), np.concatenate(status)
    return counted(draws.first, points, *every, reasons, scale, problem.threshold)


def _agreement(then: Blocks, row: int, now: Block) -> Agreement:
    counts = then.draws[row], then.violations[row], then.failed[row], then.excluded[row]
    stated, shown = (then.lowest[row], then.totals[row], then.squares[row]), (now.lowest, now.total, now.squares)
    if counts != (now.draws, now.violations, now.failed, now.excluded) or not all(map(_near, stated, shown)):
        return "differs"
    return "same bits" if now.digest == then.digests[row] and stated == shown else "within 1e-9"


def _near(stated: float | None, shown: float | None) -> bool:
    if stated is None or shown is None:
        return stated == shown
    return math.isclose(stated, shown, rel_tol=ELSEWHERE, abs_tol=ELSEWHERE)


def _same_bins(then: Blocks, blocks: Sequence[Block]) -> bool:
    """Whether the bins agree: on a machine of another kind, one flight in a million may be in the next bin."""
    bins = np.zeros(BINS + 2, dtype=np.int64)
    bins[then.places] = then.counts
    moved = np.abs(np.cumsum(bins) - np.cumsum(np.sum([block.bins for block in blocks], axis=0)))
    highest = max((block.highest for block in blocks if block.highest is not None), default=None)
    return bool(moved.max() <= ELSEWHERE * 1e3 * sum(then.counts)) and _near(then.highest, highest)
