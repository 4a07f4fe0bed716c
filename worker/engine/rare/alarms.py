"""The alarms: what shows that a mode is missing, or that the estimate rests on too few evaluations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from worker.engine.rare.evaluated import Evaluated, Floats
from worker.engine.rare.interval import Interval
from worker.engine.rare.known import Known

LARGEST, FEWEST = 0.2, 30.0
"""Of the sum, what a single evaluation may contribute; the least effective sample size of the violations."""
CHANCE = 0.005
"""How likely the independent sample may be under the interval, at the least."""
SINGLE, SINGLE_PART = 3, 0.3
"""From so many modes that the search reached once, if that is a larger part of how often it reached any, others are
likely: Good, The population frequencies of species (Biometrika 40, 1953)."""

Why = Literal["sample", "weight", "few", "unexplained", "unsaturated"]


@dataclass(frozen=True)
class Alarm:
    """Why a mode seems to be missing, with the number that shows it.

    sample: violations of the independent sample, which contradict the interval; weight: the part of the sum that one
    evaluation contributes; few: the effective sample size; unexplained: violations for which the budget did not
    suffice; unsaturated: modes that the search reached only once.
    """

    why: Why
    value: float


def effective(terms: Floats) -> float:
    """Kish's effective sample size of the violations."""
    return float(terms.sum() ** 2 / max(np.sum(terms**2), 1e-300))


def alarms(terms: Floats, found: Interval, sample: Evaluated, known: Known, left: int) -> tuple[Alarm, ...]:
    """All that apply: terms are the weights of violations, else zero; `left` violations were not explained."""
    largest = float(terms.max() / max(terms.sum(), 1e-300))
    single = sum(n == 1 for n, own in zip(known.reached, known.origins, strict=True) if own is None)
    checks: list[tuple[bool, Why, float]] = [
        (left > 0, "unexplained", left),
        (largest > LARGEST, "weight", largest),
        (effective(terms) < FEWEST, "few", effective(terms)),
        (single >= SINGLE and single > SINGLE_PART * known.reached.sum(), "unsaturated", single),
        (_contradicts(sample, found), "sample", int(np.count_nonzero(sample.violates))),
    ]
    return tuple(Alarm(why, float(value)) for raised, why, value in checks if raised)


def _contradicts(sample: Evaluated, found: Interval) -> bool:
    """Whether the independent sample has too many or too few violations for any probability in the interval."""
    from scipy import stats  # imported late, as in all of this room: a campaign's process must start fast

    count, violations = int(np.count_nonzero(~sample.excluded)), int(np.count_nonzero(sample.violates))
    many = stats.binom.sf(violations - 1, count, found.high)
    few = stats.binom.cdf(violations, count, found.low)
    return bool(min(many, few) < CHANCE / 2.0)
