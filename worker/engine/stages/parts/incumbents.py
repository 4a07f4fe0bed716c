"""The best evaluation of every search by a simulator that does not repeat, which may be a lucky draw of the noise.

Each is called again, independently of the search.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from campaigns.asked.allowance import CALLED_AGAIN
from campaigns.results import Finding
from campaigns.results.finding import Validation
from campaigns.results.validate import Incumbent
from worker.engine.stages.parts import noise, repeated
from worker.engine.stages.parts.base import all_columns
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.left import Left
from worker.engine.stages.parts.offered import Stored
from worker.engine.stages.parts.repeated import Case

Confirmed = tuple[Stored, Validation]


def called(context: Context, findings: Sequence[Finding]) -> list[Incumbent]:
    """The best of every search; none for a system that repeats. One that is a finding is not called again."""
    if not noise.noisy(context):
        return []
    known = {tuple(f.point): f.validation for f in findings if f.validation is not None}
    found = []
    for at, result in context.searched.items():
        stored = _best(context, at)
        if stored is None:
            continue
        name = f"best of {result.title}"
        validation = known.get(tuple(stored.point.tolist()))
        if validation is None or validation.cost != stored.cost:
            (validation,) = repeated.cases(context, [Case(name, stored.point, stored.cost)])
        found.append(
            Incumbent(
                position=at,
                method=result.method,
                title=result.title,
                cost=stored.cost,
                parameters=context.problem.named(stored.point),
                validation=validation.model_copy(update={"name": name, "neighbours": None}),
            )
        )
    return found


def violating(context: Context, nominal: Validation, best: Sequence[Incumbent]) -> list[Confirmed]:
    """The best of the searches, and the nominal case, of which an independent call violates; the lowest first."""
    cases = [(_best(context, b.position), b.validation) for b in best]
    if nominal.cost is not None:
        cases.append((Stored(0, 0, context.problem.nominal_point, nominal.cost, None), nominal))
    found = [(stored, v) for stored, v in cases if stored is not None and v.violates]
    return sorted(found, key=lambda pair: pair[0].cost)


def confirmed(context: Context, also: Sequence[Confirmed], left: Left) -> list[Confirmed]:
    """The lowest stored violation that one independent call confirmed, if further calls, by which it was not chosen,
    confirm it, too."""
    for stored, _ in also[: left.called_again(min(len(also), CALLED_AGAIN))]:
        (validation,) = repeated.cases(context, [stored.case])
        if validation.violates:
            return [(stored, validation)]
    return []


def _best(context: Context, position: int) -> Stored | None:
    result = context.searched[position]
    if result.best is None or result.best.index is None:
        return None
    ((_, columns),) = all_columns(context, [position])
    return Stored(position, result.best.index, np.array(columns.points[result.best.index]), result.best.cost, None)
