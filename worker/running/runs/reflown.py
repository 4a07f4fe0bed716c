"""Flies blocks of a sample again of which only a part is stored, from the seed and the indices of their draws alone.

On a machine of the same kind the digest over the bits of all costs is the same; on another, the counts and the lowest
cost agree.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from campaigns.claims.numbers import count
from campaigns.results.sample import Blocks
from campaigns.stored.blocks import Block, Scale, counted
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

    @property
    def name(self) -> str:
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
    return [_again(recorded, problem, at, samples[at], row) for at, row in (every[k] for k in chosen)]


def having(recorded: Recorded, draws: int) -> int:
    """The number of blocks that have so many draws; 0 of a run without such a sample."""
    largest = max((max(blocks.draws) for blocks in _samples(recorded).values()), default=0)
    return math.ceil(draws / largest) if largest else 0


def _samples(recorded: Recorded) -> dict[int, Blocks]:
    found = {at: result.counted for at, result in recorded.results.items() if result is not None}
    return {at: blocks for at, blocks in found.items() if blocks is not None}


def _again(recorded: Recorded, problem: Problem, position: int, then: Blocks, row: int) -> Reflown:
    draws = Draws(sum(then.draws[:row]), then.draws[row])
    drawing = Drawing(problem, recorded.sample_seed)
    noisy = recorded.measured is not None and not recorded.measured.identical
    system = slotted(problem.system).single() if noisy else problem.system
    points, seeds, reasons = drawing.points(draws), drawing.seeds(draws), dict[int, str]()
    costs, status = [], []
    for piece in _pieces(draws.number):
        batch, whys = system.evaluate(problem.vectors(points[piece]), None if seeds is None else seeds[piece])
        costs.append(batch.costs)
        status.append(batch.status)
        reasons |= {piece.start + at: why for at, why in whys.items()}
    scale = Scale(then.low, then.width)
    every = np.concatenate(costs), np.concatenate(status)
    now = counted(draws.first, points, *every, reasons, scale, problem.threshold)
    stored = (then.violations[row], then.failed[row], then.excluded[row])
    return Reflown(position, *draws, _agreement(then.digests[row], stored, then.lowest[row], now))


def _pieces(number: int) -> Iterator[slice]:
    return (slice(first, min(first + PIECE, number)) for first in range(0, number, PIECE))


def _agreement(digest: str, counts: Sequence[int], lowest: float | None, now: Block) -> Agreement:
    if now.digest == digest:
        return "same bits"
    if (now.violations, now.failed, now.excluded) != tuple(counts) or (now.lowest is None) != (lowest is None):
        return "differs"
    near = now.lowest is None or math.isclose(now.lowest, lowest or 0.0, rel_tol=ELSEWHERE, abs_tol=ELSEWHERE)
    return "within 1e-9" if near else "differs"
