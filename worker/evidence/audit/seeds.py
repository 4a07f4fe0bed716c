"""Parameters that select a realisation of noise, found again by their names."""

from __future__ import annotations

import math

from campaigns.asked.distributions import Uncertain
from worker.evidence.audit import limits

ENDS = "seed", "randomstate", "random_state", "realisation", "realization", "_rng"


def fixed(path: str, stated: Uncertain | None, nominal: float) -> bool:
    """Whether a parameter is a seed of few values, or of one, that no realisations vary."""
    part, _, name = path.rpartition(".")
    if name == "seed" and part.startswith(("environment.", "faults.")):
        return False
    stem = name.lower().rstrip("_0123456789")
    if not (f"_{stem}".endswith(ENDS) or stem.endswith(("seeds", "realisations", "realizations"))):
        return False
    if stated is None or stated.distribution.kind != "uniform":
        return True
    low, high = stated.interval(nominal)
    return math.floor(high) + 1 - math.ceil(low) < limits.REALISATIONS
