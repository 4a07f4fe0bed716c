"""The bound on a probability that a sample gives, and the samples that a bound needs.

Clopper and Pearson, The use of confidence or fiducial limits (Biometrika 26, 1934).
"""

from __future__ import annotations

import math

from campaigns.asked.values import MAX_COUNTED
from campaigns.special import beta_quantile


def needed(violations: int, samples: int, goal: float, confidence: float) -> int | None:
    """The samples at which the bound is at most `goal` if the fraction of violations stays the same, rounded up to two
    digits; None if no sample that a campaign may ask for is large enough."""
    if goal * MAX_COUNTED < 0.5 or (samples and violations / samples >= goal):
        return None
    size = _rounded(max(math.ceil(math.log1p(-confidence) / math.log1p(-goal)), samples, 1))
    while size <= MAX_COUNTED:
        expected = math.ceil(violations * size / samples) if samples else 0
        if bound(expected, size, confidence) <= goal:
            return size
        size = _rounded(math.ceil(1.1 * size) + 1)
    return None


def _rounded(size: int) -> int:
    """Up to two digits."""
    grain: int = 10 ** max(0, len(str(size)) - 2)
    return -(-size // grain) * grain


def bound(violations: int, samples: int, confidence: float) -> float:
    """The one-sided upper Clopper-Pearson bound on a probability."""
    if samples == 0 or violations >= samples:
        return 1.0
    return beta_quantile(confidence, violations + 1, samples - violations)
