"""The interval of an importance sampling estimate: log-normal, and wider by a factor that was set on known problems."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from worker.engine.rare.evaluated import Evaluated, Floats

WIDER = 1.25
"""Of the log-normal interval: the variance of skewed weights is estimated low whenever the mean is. On the problems for
setting of `tests.bench.rare`, 95.4 % of the intervals without it hold where no mode is missing."""
FLAT, RETURNS = 2.0, 0.1
"""The same where so large a part of the violations has the value of others, as with a criterion of two values: without
slopes the most likely point of a mode is hardly known."""


@dataclass(frozen=True)
class Interval:
    """P(violation), failed evaluations counted as violations, and its interval: all of [0, 1] without a violation.

    Its lower end counts failed evaluations as none; variation: the coefficient of variation of the estimate.
    """

    probability: float
    low: float
    high: float
    variation: float


def interval(weights: Floats, seen: Evaluated, sample: Evaluated, confidence: float) -> Interval:
    """The interval of P from weighted draws; excluded ones are not in the population, which a nominal sample
    measures."""
    from scipy import special

    kept = 1.0 - float(sample.excluded.mean())
    of_kept = (1.0 - kept) / max(kept * len(sample.points), 1e-300)
    values = seen.margins[seen.violates]  # a failed evaluation has none, which is one value, too
    flat = len(np.unique(values)) < (1.0 - RETURNS) * len(values)
    z = (FLAT if flat else WIDER) * float(special.ndtri((1.0 + confidence) / 2.0))
    high, wide = _mean(np.where(seen.violates, weights, 0.0), of_kept)
    low, narrow = _mean(np.where(seen.violates & ~seen.failed, weights, 0.0), of_kept)
    if high == 0.0 or kept == 0.0:
        return Interval(0.0, 0.0, 1.0, float("inf"))
    ends = low * np.exp(-z * narrow) / kept, high * np.exp(z * wide) / kept
    return Interval(min(1.0, high / kept), float(ends[0]), min(1.0, float(ends[1])), wide)


def _mean(terms: Floats, of_kept: float) -> tuple[float, float]:
    """The mean and its coefficient of variation, with the relative variance of the part that is not excluded."""
    mean = float(terms.mean())
    return mean, float(np.sqrt(terms.var(ddof=1) / len(terms) / mean**2 + of_kept)) if mean else 0.0
