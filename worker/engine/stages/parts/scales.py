"""The scale of a criterion: nominal minus worst, or what all others span where the nominal case is far above them."""

from __future__ import annotations

import numpy as np

from campaigns.limits import ROUNDING, ROUNDING_AT_LEAST, TOLERANCE_OF_MARGIN
from worker.engine.stages.parts import seeds
from worker.engine.stages.parts.context import Context
from worker.engine.systems.base import Floats

LOW, HIGH = 0.1, 0.9
"""Fractions of nominal minus worst between which there is an evaluation unless the nominal case is far above all."""
FEW = 100
"""Fewer evaluations show nothing of that."""


def scale(context: Context, worst: float) -> float:
    """Nominal minus worst [the criterion's unit]; the size of the worst if the nominal cost is not above it."""
    nominal = context.nominal_cost
    fall = 0.0 if nominal is None else nominal - worst
    return fall if fall > 0.0 else max(abs(worst), 1e-12)


def spanned(context: Context, worst: float) -> float:
    """The scale by which minima are distinguished. A simulator may return a large value where nothing is met, next to
    which every ridge is flat: as long as no finished stage has an evaluation in between, the highest below takes its
    place."""
    fall, nominal = scale(context, worst), context.nominal_cost
    if nominal is None or nominal <= worst:
        return fall
    every = [columns.ranked() for _, columns in seeds.stated(context, sorted(context.results))]
    costs = np.concatenate([np.empty(0), *every])
    while below := far_above(costs, worst, fall):
        fall = below
    return fall


def far_above(costs: Floats, worst: float, fall: float) -> float:
    """What costs (m,) span above the worst if so large a fall is far above all of them; 0 if it is not."""
    costs = costs[costs < worst + HIGH * fall]
    below = float(costs.max()) - worst if len(costs) >= FEW else 0.0
    return below if 0.0 < below < LOW * fall else 0.0


def rounding(context: Context, worst: float) -> float:
    """By how much a cost may be below the worst and differ by rounding only: a tenth of the margin at most."""
    size, margin = max(abs(worst), abs(context.problem.threshold)), abs(worst - context.problem.threshold)
    return max(min(ROUNDING * spanned(context, worst), TOLERANCE_OF_MARGIN * margin), ROUNDING_AT_LEAST * size)
