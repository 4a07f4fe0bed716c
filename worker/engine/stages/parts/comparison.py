"""Comparison of the methods: best, effort, evaluations to come near the best known, findings reached, how it ended."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from campaigns.limits import SAME_COST, SAME_PLACE
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.results.validate import Compared
from campaigns.stored.records import Columns
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.findings import Found
from worker.engine.stages.parts.scales import spanned


def compare(context: Context, findings: Sequence[Finding], found: Found, labels: list[str]) -> list[Compared]:
    """A row per search stage; `to_near_best`: evaluations until within 1 % of nominal minus worst of it; `basin`: the
    finding whose basin contains the stage's best, by the labels of the basins that were found; `minima`: the same for
    each of its own minima."""
    searched = context.searched
    worst = min((f.cost for f in findings), default=None)
    near_best = None if worst is None else worst + SAME_COST * spanned(context, worst)
    rows = []
    for at, columns in all_columns(context, list(searched)):
        result, near = searched[at], None
        if near_best is not None:
            close = (columns.status == OK) & (columns.costs[:, 0] <= near_best)
            near = int(np.argmax(close)) + 1 if close.any() else None
        best = result.best
        basin = None if best is None else _basin(found, at, best.cost, best.index, columns)
        minima = found.minima_of(at)
        rows.append(
            Compared(
                position=at,
                method=result.method,
                title=result.title,
                kind=result.kind,
                best=None if best is None else best.cost,
                evaluations=result.evaluations,
                failed=result.failed,
                excluded=result.excluded,
                seconds=result.seconds,
                to_near_best=near,
                basin=None if basin is None else labels[basin],
                apart=[
                    None if (b := _basin(found, at, a.best, a.index, columns)) is None else labels[b]
                    for a in result.apart
                ],
                findings=[f.label for f in findings if any(by.position == at for by in f.found)],
                minima=[labels[minima[i]] if i in minima else None for i in range(len(result.minima))],
                stop=result.stop,
            )
        )
    return rows


def reached(context: Context, found: Found, at: int, columns: Columns, i: int) -> int | None:
    """The evaluations that a stage needed to reach worst case `i`: to nearly its cost, close to it or with a result of
    its own in its basin, which is far where a parameter does not matter; None if it never did."""
    basin = found.basins[i]
    close = np.asarray((np.abs(columns.points - basin.point) <= SAME_PLACE).all(axis=1))
    close[[*_own(context, found, at, columns, i)]] = True
    low = (columns.status == OK) & (columns.costs[:, 0] <= basin.cost + SAME_COST * spanned(context, basin.cost))
    return int(np.argmax(low & close)) + 1 if (low & close).any() else None


def _own(context: Context, found: Found, at: int, columns: Columns, i: int) -> Iterator[int]:
    """The rows of a search's best, of those of its parts and of its minima that are in basin `i`."""
    result = context.searched[at]
    best = [] if result.best is None or result.best.index is None else [result.best.index]
    for index in (*best, *(part.index for part in result.apart)):
        if found.basin_at(columns.points[index]) == i:
            yield index
    for m in (m for m, basin in found.minima_of(at).items() if basin == i):
        yield from map(int, np.flatnonzero((columns.points == np.array(result.minima[m].point)).all(axis=1))[:1])


def _basin(found: Found, at: int, cost: float, index: int | None, columns: Columns) -> int | None:
    return found.basin_of(at, cost, None if index is None else columns.points[index])
