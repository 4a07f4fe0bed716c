"""Whether a known violation, one of the baseline, and a violating worst case are one: the costs on the line to it.

Two minima are one worst case if no barrier between them is above a fraction of nominal minus worst, however far above
the threshold that is. Two violations are not one where a case between them is clear, so that the straight line from
each known violation to the worst case of its basin is evaluated; `worker.evidence.verdicts.regression` judges it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

import numpy as np

from campaigns.limits import LINE, SAME_PLACE
from campaigns.results.stage import Reevaluated
from campaigns.results.validate import Line
from worker.engine.search.base import Batch
from worker.engine.search.parts.basin import Basin
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Floats

Lines = dict[str, list[Line]]
"""From each known violation, by its label: the line to where the worst case of its basin was, the newest last."""


def near(context: Context) -> float:
    """Fraction of every range: two cases closer than this are at one place."""
    return min(context.campaign.stages.findings.distance, SAME_PLACE)


def distance(context: Context) -> float:
    """Fraction of every range within which two minima count as one, whatever is between them. With a baseline no more
    than `near`: farther apart, a known violation would hide one behind a clear ridge."""
    return context.campaign.stages.findings.distance if context.campaign.baseline is None else near(context)


def ceiling(context: Context) -> float:
    """A case above this separates violating minima: the threshold, with what the comparison allows of every known
    violation; infinite without a baseline."""
    baseline, threshold = context.campaign.baseline, context.problem.threshold
    if baseline is None:
        return np.inf
    rounding = min((case.rounding(threshold) for case in baseline.cases if case.cost <= threshold), default=0.0)
    return threshold + max(context.campaign.regression.tolerance, rounding)


def decides(context: Context, case: Reevaluated, end: Basin) -> bool:
    """Whether the line between a case of the baseline and a worst case decides if they are one: both violate, the first
    one in the baseline, and they are not at one place."""
    baseline, threshold = context.campaign.baseline, context.problem.threshold
    violated = any(c.label == case.label and c.cost <= threshold for c in (baseline.cases if baseline else []))
    return violated and end.cost <= threshold and _apart(case.point, end.point) >= near(context)


def line(context: Context, lines: Lines, case: Reevaluated, end: Basin) -> Line | None:
    """The line to a worst case, or to where it was before it moved by less than counts as another place; None if it is
    not evaluated."""
    known = [(_apart(one.end, end.point), one) for one in lines.get(case.label, [])]
    apart, best = min(known, key=lambda one: one[0], default=(np.inf, None))
    return best if apart < near(context) else None


def joined(
    context: Context, basins: Sequence[Basin], basin_at: Callable[[Floats], int | None], lines: Lines, room: int
) -> Generator[Floats, Batch, bool]:
    """Evaluate the lines to listed worst cases that are not known yet; whether it evaluated any."""
    pairs = []
    for case in (case for result in context.results.values() for case in result.reevaluated):
        at = None if case.cost is None else basin_at(np.array(case.point))
        if at is not None and at < len(basins) and decides(context, case, basins[at]):
            end = basins[at].point.tolist()
            pairs += [(case, end)] if not any(one.end == end for one in lines.get(case.label, [])) else []
    pairs = pairs[: max(room - 1, 0) // (LINE - 1)]
    if not pairs:
        return False
    parts = np.arange(1, LINE)[:, None] / LINE
    batch = yield np.concatenate([np.array(c.point) + parts * (np.array(end) - np.array(c.point)) for c, end in pairs])
    for (case, end), costs in zip(pairs, batch.ranked().reshape(len(pairs), -1), strict=True):
        highest = float(costs.max())
        found = Line(end=end, highest=highest if np.isfinite(highest) else None)
        lines.setdefault(case.label, []).append(found)
    return True


def _apart(one: Sequence[float] | Floats, other: Sequence[float] | Floats) -> float:
    return float(np.abs(np.array(one) - np.array(other)).max(initial=0.0))
