"""Monte Carlo: random points from the campaign's distributions, drawn from one random stream.

Metropolis and Ulam, The Monte Carlo method (1949); Latin hypercubes: McKay, Beckman, Conover (Technometrics 21, 1979);
scrambled Sobol points: Owen (1998). No guarantee about the worst case. Plain points are an independent sample and
support a bound on P(violation) (Clopper and Pearson 1934); the other two fill the space more evenly and support none.
Every draw counts in the budget: an excluded one is not replaced, so that the sample is smaller, and a failed one is a
violation.

Early stopping, when the interval is narrow enough, needs interim analyses: an interval for a fixed size would hold too
rarely. Analysis k may therefore spend a fraction 1 / (k (k + 1)) of the permitted error (alpha spending), which adds up
to at most the whole for any number of analyses (Bonferroni). The sample sizes at the analyses grow by half.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from campaigns.results.base import EXCLUDED, OK
from worker.engine.search.base import Batch, Ended, Floats, Method, MethodLook, Sampling, Search, Space
from worker.engine.search.parts.proportion import interval

BLOCK = 4096
FIRST_LOOK, GROWTH = 100, 1.5
POINTS = {"latin_hypercube": "points of a Latin hypercube", "sobol": "Sobol points"}
NO_SAMPLE = "they are not an independent sample, so they give no bound on P(violation)"
EXTENDED = (
    "the sample was extended after its first result had been seen, so it gives no bound on P(violation); the certify "
    "stage draws its own sample"
)


@dataclass(frozen=True)
class Options:
    """How points are drawn, and whether the sample may end before its budget."""

    sampling: Annotated[
        Literal["plain", "latin_hypercube", "sobol"],
        Field(description="Only plain points are an independent sample, which gives a bound"),
    ] = "plain"
    interval: Annotated[
        float, Field(ge=0, lt=1, description="Stop when the interval of P(violation) is narrower than this; 0: never")
    ] = 0.0
    continued: Annotated[bool, Field(description="Extends a sample whose result was seen: gives no bound")] = False


def search(space: Space, options: Options) -> Search:
    points, drawn, violations, samples = _points(space, options.sampling), 0, 0, 0
    while drawn < space.budget:
        until = next(n for n in _sizes() if n > drawn) if options.interval > 0.0 else drawn + BLOCK
        block = np.array([next(points) for _ in range(min(until, space.budget) - drawn)])
        batch = yield space.quantile(block)
        drawn += len(block)
        violations, samples = violations + _violations(batch, space.threshold), samples + _samples(batch)
        if options.interval > 0.0 and drawn == until:
            level = interim_analyses(drawn, space.confidence)[1]
            low, high = interval(violations, samples, level)
            if high - low < options.interval:
                return Ended(
                    "precise",
                    "P(violation) is known to within {width:.3g} after {draws} draws",
                    width=high - low,
                    draws=drawn,
                )
    return Ended("drawn", "drew all {samples} samples", samples=drawn)


def sampling(options: Options, drawn: int, confidence: float) -> Sampling:
    """The kind of sample: only plain points that were not extended give a bound, at a stricter level with early
    stopping."""
    if options.sampling != "plain":
        return Sampling(POINTS[options.sampling], NO_SAMPLE)
    if options.continued:
        return Sampling(barred=EXTENDED)
    if options.interval == 0.0:
        return Sampling()
    looks, level = interim_analyses(drawn, confidence)
    return Sampling(looks=looks, level=level)


def interim_analyses(drawn: int, confidence: float) -> tuple[int, float]:
    """The number of interim analyses of a sample with early stopping after so many draws, and the confidence that the
    last one needs for all of them to hold jointly."""
    sizes = _sizes()
    analyses = next(k for k, size in enumerate(sizes, 1) if size >= drawn)
    return analyses, 1.0 - (1.0 - confidence) / (analyses * (analyses + 1))


def extend(options: Options, more: int) -> Options:
    """Extends the sample with the next random numbers and marks it as extended; raises `ValueError` if that would be a
    different sample."""
    if options.sampling == "latin_hypercube":
        raise ValueError(
            "a Latin hypercube is designed for its number of samples and cannot be extended; start again with the "
            "larger budget, or sample plain"
        )
    if options.interval > 0.0:
        raise ValueError(
            "this sample stops once its interval is narrow enough; for more precision, start it again with a narrower "
            "interval"
        )
    return replace(options, continued=True)


def _sizes() -> Iterator[int]:
    """Draws at which a sample with early stopping has an interim analysis."""
    size = float(FIRST_LOOK)
    while True:
        yield math.ceil(size)
        size *= GROWTH


def _violations(batch: Batch, threshold: float) -> int:
    """Failed evaluations count as violations, because their outcome is unknown."""
    clear = (batch.status == OK) & (batch.costs[:, 0] > threshold)
    return _samples(batch) - int(np.count_nonzero(clear))


def _samples(batch: Batch) -> int:
    return int(np.count_nonzero(batch.status != EXCLUDED))


def _points(space: Space, sampling: str) -> Iterator[Floats]:
    """Uniform samples on [0, 1), one point after another; blocks are only for speed."""
    if sampling != "plain":
        from scipy.stats import qmc  # imported late, and only where it is needed: it takes half a second

        if sampling == "latin_hypercube":
            yield from qmc.LatinHypercube(space.dimension, rng=space.random).random(space.budget)
        sobol = qmc.Sobol(space.dimension, rng=space.random)
        while True:
            yield from sobol.random(BLOCK)
    while True:
        yield from space.random.random((BLOCK, space.dimension))


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
    family="sampling",
    whole_budget=True,
    own_rule="interval",
    parallel="any number",
    suits="a bound on P(violation)",
    look=MethodLook(colour="#4a5563", dark="#c3ccd6", marker="cross", short="MC"),
    sampling=sampling,
)
