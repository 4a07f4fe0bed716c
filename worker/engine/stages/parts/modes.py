"""Which finding each mode of an estimate is: one to which the straight line from its most likely point violates.

The estimate comes before the findings are known, so the validate stage evaluates the lines, as far as its allowance
goes; what is evaluated there counts like every evaluation of the stage.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence

import numpy as np

from campaigns.claims.stages import estimate as sentences
from campaigns.limits import BETWEEN
from campaigns.results import Finding
from campaigns.results.base import OK
from campaigns.results.estimate import Estimation, NamedModes
from worker.engine.search.base import Batch, Floats
from worker.engine.search.parts.basin import Basin
from worker.engine.stages.parts.context import Context

Lines = dict[tuple[int, bytes], bool]
"""Whether all of the line violates, by the mode and the point of a worst case."""


def estimated(context: Context) -> tuple[int, Estimation] | None:
    """The position of the estimate that has modes, and the estimate."""
    found = ((at, result.estimation) for at, result in sorted(context.results.items()))
    return next(((at, one) for at, one in found if one is not None and one.modes), None)


def joined(context: Context, basins: Sequence[Basin], lines: Lines, room: int) -> Generator[Floats, Batch, bool]:
    """Evaluate the lines to violating worst cases that are not known yet; whether it evaluated any."""
    problem, of = context.problem, estimated(context)
    modes = [] if of is None else [problem.point(mode.parameters) for mode in of[1].modes]
    ends = [b.point.copy() for b in basins if b.cost <= problem.threshold]
    pairs = [(k, end) for k in range(len(modes)) for end in ends if (k, end.tobytes()) not in lines]
    pairs = pairs[: max(room - 1, 0) // len(BETWEEN)]
    if not pairs:
        return False
    points = np.array([modes[k] + part * (end - modes[k]) for part in BETWEEN for k, end in pairs])
    batch: Batch = yield points
    violates = ((batch.status == OK) & (batch.costs[:, 0] <= problem.threshold)).reshape(len(BETWEEN), -1).all(axis=0)
    lines |= {(k, end.tobytes()): bool(one) for (k, end), one in zip(pairs, violates, strict=True)}
    return True


def named(context: Context, lines: Lines, findings: Sequence[Finding]) -> NamedModes | None:
    """The findings that each mode is; None without an estimate that has modes."""
    of = estimated(context)
    if of is None:
        return None
    at, estimation = of
    keys = {finding.label: np.array(finding.point).tobytes() for finding in findings}
    violating = [f for f in findings if f.cost <= context.problem.threshold]
    modes = range(len(estimation.modes))
    compared = [[f.label for f in violating if (k, keys[f.label]) in lines] for k in modes]
    names = [[label for label in compared[k] if lines[k, keys[label]]] for k in modes]
    unknown = [len(labels) < len(violating) for labels in compared]
    unconfirmed = {f.label for f in violating if not f.violates}
    shares = None if estimation.alarms else [mode.share for mode in estimation.modes]
    statement = sentences.named(names, shares, unknown, unconfirmed)
    return NamedModes(position=at, findings=names, compared=compared, statement=statement)
