"""The alarms: what shows that a mode is missing, or that the estimate rests on too few evaluations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

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


class Counts(NamedTuple):
    """Of an independent sample: violations, failed evaluations among them, all that are not excluded, and by how much
    its probability may be above that of the estimate, which counts no violation beyond the bounds."""

    violations: int = 0
    failed: int = 0
    samples: int = 0
    outside: float = 0.0


NOTHING = Counts()
"""Without such a sample."""


@dataclass(frozen=True)
class Alarm:
    """Why a mode seems to be missing, with the number that shows it.

    sample: violations of the independent sample, which contradict the interval; weight: the part of the sum that one
    evaluation contributes; few: the effective sample size; unexplained: violations for which the budget did not
    suffice; unsaturated: modes that the search reached only once.
    """

    why: Why
    value: float
    counts: Counts = NOTHING
    """Of the sample that contradicts the interval."""


def effective(terms: Floats) -> float:
    """Kish's effective sample size of the violations."""
    return float(terms.sum() ** 2 / max(np.sum(terms**2), 1e-300))


def alarms(
    terms: Floats, found: Interval, sample: Evaluated, known: Known, left: int, certified: Counts = NOTHING
) -> tuple[Alarm, ...]:
    """All that apply: terms are the weights of violations, else zero; `left` violations were not explained; certified:
    the sample of the run, which is larger than that of the stage."""
    own = Counts(
        int(np.count_nonzero(sample.violates)),
        int(np.count_nonzero(sample.failed)),
        int(np.count_nonzero(~sample.excluded)),
    )
    shown = certified if certified.samples and _contradicts(certified, found) else own
    largest = float(terms.max() / max(terms.sum(), 1e-300))
    single = sum(n == 1 for n, own in zip(known.reached, known.origins, strict=True) if own is None)
    checks: list[tuple[bool, Why, float]] = [
        (left > 0, "unexplained", left),
        (largest > LARGEST, "weight", largest),
        (effective(terms) < FEWEST, "few", effective(terms)),
        (single >= SINGLE and single > SINGLE_PART * known.reached.sum(), "unsaturated", single),
        (_contradicts(shown, found), "sample", shown.violations),
    ]
    made = (Alarm(why, float(value)) for raised, why, value in checks if raised)
    return tuple(replace(alarm, counts=shown) if alarm.why == "sample" else alarm for alarm in made)


def _contradicts(counts: Counts, found: Interval) -> bool:
    """Whether an independent sample has too many or too few violations for any probability in the interval."""
    from scipy import stats  # imported late, as in all of this room: a campaign's process must start fast

    low, high = found.low * (1.0 - counts.outside), min(1.0, found.high + counts.outside)
    many = stats.binom.sf(counts.violations - 1, counts.samples, high)
    few = stats.binom.cdf(counts.violations, counts.samples, low)
    return bool(min(many, few) < CHANCE / 2.0)
