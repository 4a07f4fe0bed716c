"""The points from which validation descends to the worst cases: the promising evaluations of all stages.

Some of them walk downhill first, along what is stored (`worker.engine.search.parts.basins`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.allowance import STARTS, USUAL, per_finding, validation
from campaigns.stored.records import Columns
from worker.engine.search.parts.basin import Basin
from worker.engine.search.parts.basins import LOOKED_AT, downhill, promising, spread
from worker.engine.stages.parts import between, seeds
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.noise import noisy
from worker.engine.systems.base import Floats

EACH = 12
"""Limit on the points to descend from, per stage."""
CELL = 0.03
"""Fraction of every range: candidates are chosen from the lowest evaluation of every cell of this size."""
ALONE = 0.1
"""Fraction of every range: a candidate with no lower evaluation closer than this may be of a valley of its own."""


@dataclass(frozen=True)
class Candidate:
    """A point (n,) to descend from, its cost, and the stage that evaluated it."""

    point: Floats
    cost: float
    position: int
    minimum: int | None = None
    """Which of the stage's own minima it is; None if it is another evaluation."""
    followed: bool = False
    """Whether it is a case of the baseline, whose basin is reported even if it is not listed."""


def gather(context: Context, position: int) -> tuple[list[Candidate], int]:
    """The candidates of all stages before this one, the lowest first; among them the best of every stage, and of every
    part of it that was apart, and every evaluation of a stage that is followed. A small allowance is spent on few: how
    many are left out for it comes second."""
    found: list[Candidate] = []
    best: list[Candidate] = []
    searched = context.searched
    for at, columns in seeds.stated(context, range(position)):
        ranked = columns.ranked()
        known = context.results[at].followed
        rows = np.flatnonzero(np.isfinite(ranked)) if known else promising_rows(context, columns)
        mine = [Candidate(columns.points[i].copy(), float(ranked[i]), at, followed=known) for i in map(int, rows)]
        best += mine if known else mine[:1]
        found += mine
        if at in searched:
            alone = [Candidate(columns.points[part.index].copy(), part.best, at) for part in searched[at].apart]
            alone = [next((m for m in mine if np.array_equal(m.point, part.point)), part) for part in alone]
            best += [part for part in alone if part is not mine[0]]
            found += [part for part in alone if not any(part is m for m in mine)]
            found += [Candidate(np.array(m.point), m.cost, at, i) for i, m in enumerate(searched[at].minima)]
    kept = sorted(found, key=lambda c: c.cost)[: validation(context.campaign, noisy(context)).starts]
    skipped = min(len(found), per_finding(STARTS, context.campaign.stages.findings.at_most)) - len(kept)
    return sorted(kept + [b for b in best if not any(b is k for k in kept)], key=lambda c: c.cost), skipped


def promising_rows(context: Context, columns: Columns) -> NDArray[np.int64]:
    """Rows of a stage to descend from; where more findings are listed than usual, more of them, of which some are low
    although something lower is near."""
    most, ranked = context.campaign.stages.findings.at_most, columns.ranked()
    rows = spread(columns.points, ranked, CELL)
    further = CELL if most > USUAL else np.inf
    return rows[promising(columns.points[rows], ranked[rows], per_finding(EACH, most), further)]


def walked(context: Context, position: int, candidates: Sequence[Candidate], starts: Sequence[Basin]) -> frozenset[int]:
    """Move starts downhill along what is stored, in steps within which minima count as one. Returns those with nothing
    lower near.

    Not the best of a stage, nor cases of the baseline: in which basin they are is a claim, shown by lines and descents.
    """
    low = [(c, np.argsort(c.ranked(), kind="stable")[:LOOKED_AT]) for _, c in seeds.stated(context, range(position))]
    points = np.concatenate([np.empty((0, context.problem.dimension)), *(c.points[rows] for c, rows in low)])
    ranked = np.concatenate([np.empty(0), *(c.ranked()[rows] for c, rows in low)])
    searched = context.searched.items()
    bests = {(at, part.best) for at, result in searched for part in result.apart}
    bests |= {(at, result.best.cost) for at, result in searched if result.best is not None}
    alone = set()
    for i, (start, candidate) in enumerate(zip(starts, candidates, strict=True)):
        if not candidate.followed:
            claimed = (candidate.position, candidate.cost) in bests
            moved = replace(start) if claimed else start
            if downhill(moved, points, ranked, between.distance(context)) > ALONE:
                alone.add(i)
    return frozenset(alone)
