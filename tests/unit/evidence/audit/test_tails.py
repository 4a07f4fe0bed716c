"""The probability beyond the bounds: engine and audit compute the same, to the last number that is not zero."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy import special

from campaigns.asked.distributions import Correlation, Distribution, Normal, Uniform
from tests.given.at_night import nightly_but
from worker.engine.problem.distributions import Distributions, Range
from worker.evidence.audit.recompute import Run

SIDES = ("below", "above", "both")
FAR = 50.0
"""A bound without a tail [standard deviations]."""
WIDE = Normal(mean=0.0, deviation=1.0)
"""With a tail of 5 % between -1.96 and 1.96."""


def computed(ranges: list[Range], correlations: list[Correlation]) -> tuple[float, float]:
    """By the engine, and by the audit."""
    uncertain = {r.path: SimpleNamespace(distribution=r.distribution) for r in ranges}
    campaign = SimpleNamespace(uncertain=uncertain, correlations=correlations)
    run = SimpleNamespace(campaign=campaign, bounds={r.path: (r.low, r.high) for r in ranges})
    return Distributions(ranges, correlations).outside, Run.outside(cast(Any, run))


def normal(path: str, k: int, score: float, side: str) -> Range:
    low, high = (FAR if side == "above" else score, FAR if side == "below" else score)
    return Range(path, k, 7.0 - 0.3 * low, 7.0 + 0.3 * high, 7.0, Normal(mean=7.0, deviation=0.3))


@pytest.mark.parametrize("every", nightly_but((5,), (1, 5)))
@pytest.mark.parametrize("side", SIDES)
def test_engine_and_audit_agree_on_every_tail(side: str, every: int) -> None:
    flat: Distribution = Uniform()
    wide = [Range(path, 2 + k, -1.96, 1.96, 0.0, WIDE) for k, path in enumerate(("c.c", "d.d"))]
    pair = [Correlation(between=["a.a", "b.b"], value=0.5)]
    for score in np.concatenate([np.linspace(0.01, 40.0, 400), np.linspace(37.4, 38.6, 1201)])[::every]:
        one = [normal("a.a", 0, score, side), Range("b.b", 1, 0.0, 1.0, 0.5, flat)]
        for ranges in (one, one + wide):
            for correlations in ([], pair):
                engine, audit = computed(ranges, correlations)
                assert engine == pytest.approx(audit, rel=1e-14, abs=0.0), score
                assert (engine > 0.0) == (audit > 0.0), score
        tail, _ = computed(one, pair)
        exact = float(np.exp(special.log_ndtr(-score))) * (2.0 if side == "both" else 1.0)
        assert tail == pytest.approx(exact, rel=1e-11, abs=1e-320), score
        assert tail > 0.0 or score > 38.4, score
