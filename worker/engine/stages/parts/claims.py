"""What may be claimed from a random sample, as numbers; the sentences are in `worker.engine.stages.parts.sample`.

Clopper and Pearson, The use of confidence or fiducial limits (Biometrika 26, 1934); Wilks, Determination of sample
sizes for setting tolerance limits (Annals of Mathematical Statistics 12, 1941); Massart, The tight constant in the
Dvoretzky-Kiefer-Wolfowitz inequality (Annals of Probability 18, 1990).
"""

from __future__ import annotations

import math
from bisect import bisect_left

LEAST = 1e-12
"""A fraction so small is none: three trillion samples bound a quantile there, and a campaign has at most a billion."""
ROUNDING = 4e-15
"""Of a quotient of logarithms: 2 samples, not 3, for the median with 75 % confidence."""


def bound(violations: int, samples: int, confidence: float) -> float:
    """One-sided upper Clopper-Pearson bound on a probability, given `violations` among `samples`."""
    from scipy import special  # imported late, here and below; scipy.stats takes half a second more

    if samples == 0 or violations >= samples:
        return 1.0
    return float(special.betaincinv(violations + 1, samples - violations, confidence))


def allowed(samples: int, most: float, confidence: float) -> int:
    """The largest number of violations among `samples` for which `bound` is at most `most`; -1 if there is none."""
    return bisect_left(range(samples), True, key=lambda events: bound(events, samples, confidence) > most) - 1


def order(samples: int, fraction: float, confidence: float) -> int:
    """Wilks: the highest r so that the r-th lowest of the sample is at most the quantile at `fraction`; 0 for none.

    One-sided, for any distribution: P(r-th lowest <= quantile) is at least P(Binomial(samples, fraction) >= r).
    """
    if samples == 0 or not 0.0 < fraction < 1.0:
        return 0
    return bisect_left(range(1, samples + 1), True, key=lambda r: confidence_of(r, samples, fraction) < confidence)


def confidence_of(r: int, samples: int, fraction: float) -> float:
    """The confidence with which the r-th lowest of the sample is at most the quantile at `fraction`."""
    from scipy import special

    return float(special.betainc(r, samples - r + 1, fraction)) if 0 < r <= samples and fraction > 0.0 else 0.0


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


def band(samples: int, confidence: float, redrawn: float = 0.0) -> float:
    """Half the width of the band around the sample's distribution function that holds the whole one within the bounds.

    redrawn: the probability of a draw that was moved inside, by which the distribution of the draws may differ from the
    one within the bounds, however many there are.
    """
    return min(1.0, math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * samples)) + redrawn) if samples else 1.0
