"""What may be claimed from a random sample, as numbers; the sentences are in `worker.engine.stages.parts.sample`.

Clopper and Pearson, The use of confidence or fiducial limits (Biometrika 26, 1934); Wilks, Determination of sample
sizes for setting tolerance limits (Annals of Mathematical Statistics 12, 1941); Massart, The tight constant in the
Dvoretzky-Kiefer-Wolfowitz inequality (Annals of Probability 18, 1990).
"""

from __future__ import annotations

import math

LEAST = 1e-12
"""A fraction so small is none: three trillion samples bound a quantile there, and a campaign has at most a billion."""
ROUNDING = 4e-15
"""Of a quotient of logarithms: 2 samples, not 3, for the median with 75 % confidence."""


def bound(violations: int, samples: int, confidence: float) -> float:
    """One-sided upper Clopper-Pearson bound on a probability, given `violations` among `samples`."""
    from scipy import stats  # imported late, here and below: a campaign's process must start fast

    if samples == 0 or violations >= samples:
        return 1.0
    return float(stats.beta.ppf(confidence, violations + 1, samples - violations))


def allowed(samples: int, most: float, confidence: float) -> int:
    """The largest number of violations among `samples` for which `bound` is at most `most`; -1 if there is none."""
    low, high = -1, samples
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if bound(middle, samples, confidence) <= most else (low, middle)
    return low


def interval(events: int, samples: int, confidence: float, unknown: int = 0) -> tuple[float, float]:
    """Two-sided Clopper-Pearson interval of a probability; `unknown` samples count as none below, as events above."""
    from scipy import stats

    tail, above = (1.0 - confidence) / 2, events + unknown
    low = float(stats.beta.ppf(tail, events, samples - events + 1)) if events else 0.0
    high = float(stats.beta.ppf(1.0 - tail, above + 1, samples - above)) if above < samples else 1.0
    return low, high


def order(samples: int, fraction: float, confidence: float) -> int:
    """Wilks: the highest r so that the r-th lowest of the sample is at most the quantile at `fraction`; 0 for none.

    One-sided, for any distribution: P(r-th lowest <= quantile) is at least P(Binomial(samples, fraction) >= r).
    """
    from scipy import stats

    if samples == 0 or not 0.0 < fraction < 1.0:
        return 0
    r = int(stats.binom.ppf(1.0 - confidence, samples, fraction))
    while confidence_of(r + 1, samples, fraction) >= confidence:
        r += 1
    while r > 0 and confidence_of(r, samples, fraction) < confidence:
        r -= 1
    return r


def confidence_of(r: int, samples: int, fraction: float) -> float:
    """The confidence with which the r-th lowest of the sample is at most the quantile at `fraction`."""
    from scipy import stats

    return float(stats.binom.sf(r - 1, samples, fraction)) if 0 < r <= samples and fraction > 0.0 else 0.0


def needed(fraction: float, confidence: float) -> int | None:
    """The smallest sample whose lowest value bounds the quantile at `fraction`: 59 for 5 % with 95 % confidence.

    None where no sample is large enough that a campaign may ask for.
    """
    if fraction < LEAST:
        return None
    none, each = math.log1p(-confidence) * (1.0 - ROUNDING), math.log1p(-fraction)
    size = max(1, math.floor(none / each) - 1)
    while size * each > none:
        size += 1
    return size


def band(samples: int, confidence: float) -> float:
    """Half the width of the band around the sample's distribution function that holds the whole one of its draws."""
    return min(1.0, math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * samples))) if samples else 1.0
