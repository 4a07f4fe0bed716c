"""The alarms: what shows that a mode is missing, or that the estimate rests on too few evaluations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from worker.engine.rare.evaluated import Evaluated, Floats
from worker.engine.rare.interval import Interval

LARGEST = 0.2
"""Of the sum, which a single evaluation may contribute."""
CHANCE = 0.005
"""How likely the independent sample may be under the interval, at the least."""


@dataclass(frozen=True)
class Alarm:
    """Why a mode seems to be missing, with the number that shows it.

    sample: violations of the independent sample against the interval, their number; weight: one evaluation contributes
    so much of the sum; unexplained: violations for which the budget did not suffice, their number; none: no violation
    among the draws of the estimate.
    """

    why: Literal["sample", "weight", "unexplained", "none"]
    value: float


def alarms(terms: Floats, found: Interval, sample: Evaluated, left: int) -> tuple[Alarm, ...]:
    """All that apply: terms are the weights of violations, else zero; `left` violations were not explained."""
    given: list[Alarm] = []
    if left:
        given.append(Alarm("unexplained", left))
    if not terms.any():
        return (*given, Alarm("none", 0.0))
    largest = float(terms.max() / terms.sum())
    if largest > LARGEST:
        given.append(Alarm("weight", largest))
    if _contradicts(sample, found):
        given.append(Alarm("sample", int(np.count_nonzero(sample.violates))))
    return tuple(given)


def _contradicts(sample: Evaluated, found: Interval) -> bool:
    """Whether the independent sample has too many or too few violations for any probability in the interval."""
    from scipy import stats  # imported late: a campaign's process must start fast

    count, violations = int(np.count_nonzero(~sample.excluded)), int(np.count_nonzero(sample.violates))
    many = stats.binom.sf(violations - 1, count, found.high)
    few = stats.binom.cdf(violations, count, found.low)
    return bool(min(many, few) < CHANCE / 2.0)
