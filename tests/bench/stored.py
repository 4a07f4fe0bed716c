"""The time of what is computed from stored evaluations, and its values on cases with known answers: likelihood,
re-weighting, coverage. `tests.bench.certainty` prints it and stores it with its own figures.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from backend.likelihood.service import MOST
from backend.results.coverage.read import MOST as COVERED
from backend.results.coverage.read import Used, covered
from campaigns import Campaign
from campaigns.asked.distributions import TruncatedNormal
from campaigns.densities.joint import Joint, joined
from campaigns.densities.likelihood import Rows, likelihood, most_likely
from campaigns.densities.reweighting import Drawn, Terms, reweighted

THRESHOLD, CONFIDENCE = -2.0, 0.95
"""A standard normal parameter is the cost: P(violation) is that of its tail."""
BOUNDS = {"a": (-8.0, 8.0), "b": (0.0, 1.0)}
TAIL = math.erfc(2.0 / math.sqrt(2.0)) / 2.0
MOVED = math.erfc(1.5 / math.sqrt(2.0)) / 2.0
"""The same once the mean is half a standard deviation lower."""


def normal(mean: float) -> Joint:
    parts = {"a": TruncatedNormal(mean=mean, deviation=1.0), "b": TruncatedNormal(mean=0.5, deviation=0.25)}
    return joined(parts, [], BOUNDS)


def measured(campaign: Campaign) -> dict[str, Any]:
    """Seconds and values; campaign: one of two uniform parameters, for coverage."""
    of, random = normal(0.0), np.random.default_rng(1)
    points = of.drawn(random.random((MOST, 2)))
    costs, status = of.values(points)[:, 0], np.zeros(MOST, np.uint8)
    rows = Rows(0, 0, points, costs[:, None], status)
    taken, most = _timed(lambda: most_likely(THRESHOLD, of, {"a": 0.0, "b": 0.5}, [rows], ""))
    each, one = _timed(lambda: likelihood(of, np.array([(THRESHOLD - BOUNDS["a"][0]) / 16.0, 0.5])))
    again, found = _timed(
        lambda: reweighted(of, normal(-0.5), Drawn(points, costs, status), Terms(THRESHOLD, CONFIDENCE, [0.5]))
    )
    cube, threshold = random.random((COVERED, 2)), campaign.criterion.threshold
    over, cover = _timed(lambda: covered(Used(cube, threshold + 1.0 + cube[:, 0], COVERED), campaign, None))
    assert most.case is not None
    assert cover.possible is not None
    return {
        "draws": MOST,
        "likelihood": {"seconds": each, "distance": one.distance, "exact_distance": -THRESHOLD},
        "most_likely": {"seconds": taken, "violations": most.violations, "cost": most.case.cost, "exact": THRESHOLD},
        "reweighting": {
            "seconds": again, "probability": found.probability, "low": found.low, "high": found.high,
            "exact_probability": MOVED,
            "probability_of_the_draws": float(np.mean(costs <= THRESHOLD)), "exact_of_the_draws": TAIL,
        },
        "coverage": {
            "seconds": over, "evaluations": COVERED, "slope": cover.possible.slope, "exact_slope": 1.0,
            "possible": cover.possible.fraction, "exact_possible": 0.0,
        },
    }  # fmt: skip


def line(found: dict[str, Any]) -> str:
    weighted, cover = found["reweighting"], found["coverage"]
    return (
        f"re-weighting of {found['draws']:,} draws: {weighted['seconds']:.2f} s, P = {weighted['probability']:.4f} "
        f"[{weighted['low']:.4f}, {weighted['high']:.4f}], exact {weighted['exact_probability']:.4f}; the most likely "
        f"violation among them: {found['most_likely']['seconds']:.3f} s; one likelihood: "
        f"{1e6 * found['likelihood']['seconds']:.0f} us; coverage of {cover['evaluations']:,} evaluations: "
        f"{cover['seconds']:.2f} s, slope {cover['slope']:.4f}, exact {cover['exact_slope']:.0f}"
    )


def _timed(work: Callable[[], Any]) -> tuple[float, Any]:
    began = time.perf_counter()
    found = work()
    return time.perf_counter() - began, found
