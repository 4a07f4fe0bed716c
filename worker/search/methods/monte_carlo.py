"""Monte Carlo: random points from the campaign's distributions, one after another from one stream of numbers.

Metropolis and Ulam, The Monte Carlo method (1949); Latin hypercubes: McKay, Beckman, Conover (Technometrics 21, 1979);
scrambled Sobol points: Owen (1998). Guarantees nothing of the worst case. Plain points are an independent sample, so a
statement on P(violation) may rest on them (Clopper and Pearson 1934); the two others fill the space more evenly and
allow none. An excluded point is drawn again and counted; a failed one is counted and never replaced.

A sample that stops when its interval is narrow enough was looked at before it ended: an interval for a fixed size would
hold too seldom. So look k may err with a share 1 / (k (k + 1)) of the error allowed, which adds up to all of it however
many looks there are (Bonferroni), and the looks come at sizes that grow by half.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from campaigns.results.base import EXCLUDED, OK
from worker.search.base import Batch, Ended, Floats, Method, MethodLook, Search, Space

BLOCK = 4096
FIRST_LOOK, GROWTH = 100, 1.5


@dataclass(frozen=True)
class Options:
    """How points are drawn, and whether the sample may end before its budget."""

    sampling: Annotated[
        Literal["plain", "latin_hypercube", "sobol"],
        Field(description="Only plain points are an independent sample, from which a bound follows"),
    ] = "plain"
    interval: Annotated[
        float, Field(ge=0, lt=1, description="Stop when the interval of P(violation) is narrower; 0: never")
    ] = 0.0
    continued: Annotated[
        bool, Field(description="Goes on with a sample whose result was seen: no bound follows from it")
    ] = False


def search(space: Space, options: Options) -> Search:
    points, drawn, violations, samples = _points(space, options.sampling), 0, 0, 0
    while drawn < space.budget:
        until = next(n for n in _sizes() if n > drawn) if options.interval > 0.0 else drawn + BLOCK
        block = np.array([next(points) for _ in range(min(until, space.budget) - drawn)])
        batch = yield space.quantile(block)
        drawn += len(block)
        violations, samples = violations + _violations(batch, space.threshold), samples + _samples(batch)
        if options.interval > 0.0 and drawn == until:
            level = looked(drawn, space.confidence)[1]
            low, high = interval(violations, samples, level)
            if high - low < options.interval:
                return Ended(
                    "precise",
                    "P(violation) is known to within {width:.3g} after {draws} draws",
                    width=high - low,
                    draws=drawn,
                )
    return Ended("drawn", "drew the {samples} samples asked for", samples=drawn)


def looked(drawn: int, confidence: float) -> tuple[int, float]:
    """How often a sample that may stop early was looked at until its end after so many draws, and the confidence that
    this look must be made with for all of them to hold together."""
    sizes = _sizes()
    looks = next(k for k, size in enumerate(sizes, 1) if size >= drawn)
    return looks, 1.0 - (1.0 - confidence) / (looks * (looks + 1))


def interval(violations: int, samples: int, confidence: float) -> tuple[float, float]:
    """The two-sided interval of Clopper and Pearson."""
    from scipy.stats import beta  # a campaign's process must start fast

    error = (1.0 - confidence) / 2
    low = beta.ppf(error, violations, samples - violations + 1) if violations else 0.0
    high = beta.ppf(1.0 - error, violations + 1, samples - violations) if violations < samples else 1.0
    return float(low), float(high)


def extend(options: Options, more: int) -> Options:
    """Goes on with the next numbers of the stream, as a sample known to be continued; raises `ValueError` where that
    would be another sample."""
    if options.sampling == "latin_hypercube":
        raise ValueError(
            "a Latin hypercube is laid out for its number of samples and cannot go on; run it anew with the larger "
            "budget, or sample plain"
        )
    if options.interval > 0.0:
        raise ValueError(
            "this sample was to stop once its interval is narrow enough; to know it better, run it anew with a "
            "narrower interval"
        )
    return replace(options, continued=True)


def _sizes() -> Iterator[int]:
    """Draws at which a sample that may stop early is looked at."""
    size = float(FIRST_LOOK)
    while True:
        yield math.ceil(size)
        size *= GROWTH


def _violations(batch: Batch, threshold: float) -> int:
    """Failed flights are violations: nobody knows how they would have ended."""
    clear = (batch.status == OK) & (batch.costs[:, 0] > threshold)
    return _samples(batch) - int(np.count_nonzero(clear))


def _samples(batch: Batch) -> int:
    return int(np.count_nonzero(batch.status != EXCLUDED))


def _points(space: Space, sampling: str) -> Iterator[Floats]:
    """Numbers uniform on [0, 1), one point after another; blocks are for speed alone."""
    from scipy.stats import qmc

    if sampling == "latin_hypercube":
        yield from qmc.LatinHypercube(space.dimension, rng=space.random).random(space.budget)
    sobol = qmc.Sobol(space.dimension, rng=space.random) if sampling == "sobol" else None
    while True:
        yield from space.random.random((BLOCK, space.dimension)) if sobol is None else sobol.random(BLOCK)


method = Method(
    name="monte_carlo",
    title="Monte Carlo",
    kind="random",
    how="Random points, the reference method",
    source="Metropolis and Ulam 1949",
    evaluations=1000,
    options=Options,
    search=search,
    extend=extend,
    look=MethodLook(colour="mc", marker="cross", short="MC"),
)
