"""Joint densities of a few parameters, and draws from them as runs make them."""

from __future__ import annotations

import numpy as np

from campaigns.asked.distributions import Correlation, Distribution
from campaigns.cube import Floats
from campaigns.densities.joint import Joint, joined
from worker.engine.problem.distributions import Distributions, Range

LOW, HIGH = 4.0, 6.0


def made(*kinds: Distribution, correlation: float = 0.0) -> Joint:
    """Parameters a.0, a.1, ... within 4 to 6; the first two are correlated."""
    kinds_of = {f"a.{k}": kind for k, kind in enumerate(kinds)}
    pairs = [Correlation(between=["a.0", "a.1"], value=correlation)] if correlation else []
    return joined(kinds_of, pairs, dict.fromkeys(kinds_of, (LOW, HIGH)))


def drawn(*kinds: Distribution, correlation: float = 0.0, count: int = 100_000, seed: int = 3) -> Floats:
    """Points of the unit cube as a run draws them."""
    ranges = [Range(f"a.{k}", k, LOW, HIGH, 5.0, kind) for k, kind in enumerate(kinds)]
    pairs = [Correlation(between=["a.0", "a.1"], value=correlation)] if correlation else []
    uniform = np.random.default_rng(seed).random((count, len(kinds)))
    return Distributions(ranges, pairs).quantile(uniform)
