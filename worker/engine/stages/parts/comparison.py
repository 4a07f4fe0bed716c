"""Comparison of the methods: best, effort, evaluations to come near the best known, findings reached, how it ended."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from campaigns.limits import SAME_COST
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.results.validate import Compared
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.findings import Found, scale


def compare(context: Context, findings: Sequence[Finding], found: Found, labels: list[str]) -> list[Compared]:
    """A row per search stage; `to_near_best`: evaluations until within 1 % of nominal minus worst of it; `basin`: the
    finding whose basin contains the stage's best, by the labels of the basins that were found; `minima`: the same for
    each of its own minima."""
    searched = context.searched
    worst = min((f.cost for f in findings), default=None)
    rows = []
    for at, columns in all_columns(context, list(searched)):
        result, near = searched[at], None
        if worst is not None:
            close = (columns.status == OK) & (columns.costs[:, 0] <= worst + SAME_COST * scale(context, worst))
            near = int(np.argmax(close)) + 1 if close.any() else None
        best = result.best
        basin = None if best is None else found.basin_of(at, best.cost)
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
                apart=[None if (b := found.basin_of(at, a.best)) is None else labels[b] for a in result.apart],
                findings=[f.label for f in findings if any(by.position == at for by in f.found)],
                minima=[labels[minima[i]] if i in minima else None for i in range(len(result.minima))],
                stop=result.stop,
            )
        )
    return rows
