"""The interval of an unknown probability from independent draws.

Clopper and Pearson, The use of confidence or fiducial limits (Biometrika 26, 1934).
"""

from __future__ import annotations


def interval(events: int, samples: int, confidence: float, unknown: int = 0) -> tuple[float, float]:
    """Two-sided Clopper-Pearson interval of a probability; `unknown` samples count as none below, as events above."""
    from scipy import special

    tail, above = (1.0 - confidence) / 2, events + unknown
    low = float(special.betaincinv(events, samples - events + 1, tail)) if events else 0.0
    high = float(special.betaincinv(above + 1, samples - above, 1.0 - tail)) if above < samples else 1.0
    return low, high
