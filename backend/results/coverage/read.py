"""Reads how much of the box of the bounds a run's evaluations cover: computed when it is requested, not stored."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import sqlalchemy as sa

from backend.catalog.criteria import criteria
from backend.catalog.service import bounds, described
from backend.db.rows import as_array, chunks
from backend.db.tables import EvaluationChunk, Stage
from backend.results.coverage import ball, slopes
from backend.results.coverage.schemas import Coverage, EmptyBall, PairCoverage
from backend.results.coverage.tree import Floats
from backend.runs.service import campaign
from campaigns import Campaign, Catalogue, cube, thin
from campaigns.checked.check import parameters
from campaigns.claims import coverage as words
from campaigns.claims.say import symbol
from campaigns.claims.spans import Spans
from campaigns.results.base import OK
from campaigns.symbols import labels

MOST = 20_000
"""Evaluations of a run that are used, and fewer from 13 parameters on: so the work is bounded, at about 0.4 s."""
NUMBERS = 12 * MOST
"""Parameters of all evaluations that are used."""

BINS = 10
"""Of each range; a pair has the square of it."""
_COLUMNS = [getattr(EvaluationChunk, name) for name in ("first", "count", "points", "costs", "status")]


class Used(NamedTuple):
    points: Floats
    costs: Floats
    """NaN without a value."""
    total: int


def read(reader: sa.Connection, run_id: int) -> Coverage:
    """The coverage by the evaluations of all stages so far; 404 if there is no such run."""
    request = campaign(reader, run_id)
    return covered(_used(reader, run_id, len(request.uncertain)), request, described(reader, run_id))


def covered(used: Used, request: Campaign, catalogue: Catalogue | None) -> Coverage:
    """The figures of these evaluations, and the sentences on them."""
    valued = np.isfinite(used.costs)
    found = Coverage(
        total=used.total,
        used=len(used.points),
        without_value=int(np.count_nonzero(~valued)),
        ball=_ball(used.points, request, catalogue) if len(used.points) else None,
        bins=BINS**2,
        pairs=pairs(used.points, list(request.uncertain)),
        possible=slopes.possible(used.points[valued], used.costs[valued], request.criterion.threshold),
        statements=[],
    )
    return found.model_copy(update={"statements": _statements(found, request, catalogue)})


def _used(reader: sa.Connection, run_id: int, dimension: int) -> Used:
    """An even choice of the evaluations of all stages, in the order of the stages."""
    query = sa.select(Stage.position, Stage.evaluations).where(Stage.run_id == run_id).order_by(Stage.position)
    stages = reader.execute(query).all()
    total = sum(stage.evaluations for stage in stages)
    chosen, before = thin.even(total, min(MOST, NUMBERS // dimension)), 0
    points, costs = [np.empty((0, dimension))], [np.empty(0)]
    for stage in stages:
        for chunk in chunks(reader, run_id, stage.position, *_COLUMNS):
            first, last = np.searchsorted(chosen, [before + chunk.first, before + chunk.first + chunk.count])
            rows = chosen[first:last] - before - chunk.first
            cube_points, every = (as_array(data, chunk.count) for data in (chunk.points, chunk.costs))
            ok = np.frombuffer(chunk.status, dtype=np.uint8) == OK
            points.append(cube_points[rows, :dimension])
            costs.append(np.where(ok, every[:, 0], np.nan)[rows])
        before += stage.evaluations
    return Used(np.concatenate(points), np.concatenate(costs), total)


def _ball(points: Floats, request: Campaign, catalogue: Catalogue | None) -> EmptyBall:
    found, limits = ball.largest(points), bounds(request, catalogue)
    shares = dict(zip(request.uncertain, found.centre, strict=True))
    centre = {path: float(cube.natural(shares[path], *limits[path])) for path in limits}
    return EmptyBall(radius=_rounded_down(found.radius), diagonal=math.sqrt(len(shares)), centre=centre)


def _rounded_down(radius: float) -> float:
    """To three digits, so that the ball that is shown is empty, too."""
    if radius <= 0.0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(radius)) - 2)
    return min(radius, round(math.floor(radius / step) * step, 15))


def pairs(points: Floats, paths: Sequence[str]) -> list[PairCoverage]:
    """Which bins of every pair of parameters have an evaluation, the least covered first; points: (m, n).

    Kuhn, Kacker, Lei (NIST SP 800-142, 2010), section 2, with equal bins of a range as the values of a parameter.
    """
    bins = np.minimum((points * BINS).astype(np.int64), BINS - 1)
    found = [
        PairCoverage(
            first=paths[a],
            second=paths[b],
            touched=int(np.count_nonzero(np.bincount(bins[:, a] * BINS + bins[:, b], minlength=BINS**2))),
        )
        for a, b in itertools.combinations(range(points.shape[1]), 2)
    ]
    return sorted(found, key=lambda pair: pair.touched)


def _statements(found: Coverage, request: Campaign, catalogue: Catalogue | None) -> list[Spans]:
    if found.ball is None:
        return [words.NO_EVALUATION, words.NO_PROOF]
    known = {} if catalogue is None else parameters(request, catalogue)
    names = labels(request.uncertain, {path: entry.symbol for path, (entry, _) in known.items()})
    named = {path: symbol(path, label) for path, label in names.items()}
    unit, volume = criteria(request.document(), catalogue)[0].unit, found.possible
    return [
        words.used(found.used, found.total),
        *([words.without_value(found.without_value)] if found.without_value else []),
        words.ball(found.ball.radius, found.ball.diagonal),
        *(words.bins(named[pair.first], named[pair.second], pair.touched, found.bins) for pair in found.pairs[:1]),
        words.NO_SLOPE
        if volume is None
        else words.volume(volume.slope, unit, slopes.APART, volume.fraction, volume.points, volume.standard_error),
        words.NO_PROOF,
    ]
