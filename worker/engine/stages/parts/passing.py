"""Cases of a baseline that violated there and do not here: each is confirmed as a finding is, because one evaluation at
one step, or a few calls, may miss the violation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from campaigns.results.finding import Validation
from worker.engine.stages.parts.confirm import cases
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.left import Left
from worker.engine.stages.parts.offered import Stored

Passing = dict[int, tuple[Stored, Validation]]
"""By the number of the case."""


def confirmed(context: Context, left: Left) -> Passing:
    """Those of the baseline's cases that violate no more, as far as the allowance goes."""
    baseline, threshold = context.campaign.baseline, context.problem.threshold
    position = next((at for at, result in context.results.items() if result.reevaluated), None)
    if baseline is None or position is None:
        return {}
    found: dict[int, Stored] = {}
    for k, (case, again) in enumerate(zip(baseline.cases, context.results[position].reevaluated, strict=True)):
        if again.index is None or again.cost is None or again.cost <= threshold:
            continue
        if baseline.violated(case, threshold):
            found[k] = Stored(position, again.index, np.array(again.point), again.cost, again.realisation)
    some = [*found.items()][: left.cases(len(found))]
    named = [replace(stored.case, name=f"{baseline.cases[k].label} of {baseline.run}") for k, stored in some]
    made = cases(context, named)
    return {k: (stored, validation) for (k, stored), validation in zip(some, made, strict=True)}


def violating(found: Passing) -> list[tuple[Stored, Validation]]:
    """Those of which an independent call violates, the lowest first."""
    return sorted((pair for pair in found.values() if pair[1].violates), key=lambda pair: pair[0].cost)
