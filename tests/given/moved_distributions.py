"""Samples of one parameter that are re-weighted to another distribution, with the exact probability of a violation."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from campaigns.asked.distributions import Beta, Distribution, Normal, Triangular, TruncatedNormal, Uniform
from campaigns.densities.joint import joined
from campaigns.densities.reweighting import Drawn, Terms, reweighted
from campaigns.results.base import OK
from campaigns.results.reweighted import Reweighted
from tests.given.stated_densities import HIGH, LOW, drawn

BELOW, ABOVE = -math.inf, math.inf


class Case(NamedTuple):
    """The stated distribution is within 4 to 6, the moved one within `within`; `regions` violate, or all but them."""

    stated: Distribution
    moved: Distribution
    regions: tuple[tuple[float, float], ...]
    draws: int
    within: tuple[float, float] = (LOW, HIGH)
    others: bool = False

    @property
    def exact(self) -> float:
        of = law(self.moved, *self.within)
        p = float(sum(of.cdf(high) - of.cdf(low) for low, high in self.regions))
        return 1.0 - p if self.others else p

    def violates(self, values: np.ndarray) -> np.ndarray:
        inside = np.any([(values >= low) & (values <= high) for low, high in self.regions], axis=0)
        return np.asarray(~inside if self.others else inside)


def law(kind: Distribution, low: float = LOW, high: float = HIGH) -> Any:
    """The distribution as SciPy has it."""
    if isinstance(kind, Normal):
        return stats.norm(kind.mean, kind.deviation)
    if isinstance(kind, TruncatedNormal):
        ends = [(end - kind.mean) / kind.deviation for end in (low, high)]
        return stats.truncnorm(*ends, kind.mean, kind.deviation)
    if isinstance(kind, Triangular):
        return stats.triang((kind.mode - low) / (high - low), low, high - low)
    if isinstance(kind, Beta):
        return stats.beta(kind.alpha, kind.beta, low, high - low)
    return stats.uniform(low, high - low)


def estimate(case: Case, seed: int) -> Reweighted:
    points = drawn(case.stated, count=case.draws, seed=seed)
    costs = np.where(case.violates(LOW + (HIGH - LOW) * points[:, 0]), 0.0, 1.0)
    stated = joined({"a.0": case.stated}, [], {"a.0": (LOW, HIGH)})
    moved = joined({"a.0": case.moved}, [], {"a.0": case.within})
    return reweighted(stated, moved, Drawn(points, costs, np.full(case.draws, OK, np.uint8)), Terms(0.5, 0.95, ()))


class Coverage(NamedTuple):
    """Of the estimates that were made: their number, the fractions that have the exact probability, and those below and
    above it, the mean of the estimates and the mean width."""

    made: int
    held: float
    below: float
    above: float
    mean: float
    width: float


def coverage(case: Case, seeds: Iterable[int]) -> Coverage:
    found = [estimate(case, seed) for seed in seeds]
    rows = np.array([(f.low, f.probability, f.high) for f in found if f.low is not None], float).reshape(-1, 3)
    if not len(rows):
        return Coverage(0, *[math.nan] * 5)
    below, above = rows[:, 2] < case.exact, rows[:, 0] > case.exact
    of = (1.0 - np.mean(below | above), below.mean(), above.mean(), rows[:, 1].mean(), (rows[:, 2] - rows[:, 0]).mean())
    return Coverage(len(rows), *map(float, of))


def _normal(mean: float, deviation: float = 0.2) -> Normal:
    return Normal(mean=mean, deviation=deviation)


SINGLE: dict[str, Case] = {
    "a shift towards the violations": Case(_normal(5.0), _normal(4.8), ((BELOW, 4.6),), 1000),
    "a shift away from them": Case(_normal(5.0), _normal(5.2), ((BELOW, 4.6),), 1000),
    "violations in the middle": Case(_normal(5.0), _normal(5.2), ((4.98, 5.02),), 1000),
    "a wider one, whose violations are rare in the sample": Case(
        _normal(5.0), _normal(5.0, 0.26), ((BELOW, 4.4),), 1000
    ),
    "a triangle made uniform, whose violations are rare in the sample": Case(
        Triangular(mode=5.0), Uniform(), ((BELOW, 4.02),), 3000
    ),
    "a narrower box": Case(Uniform(), Uniform(), ((BELOW, 4.1),), 1000, (4.0, 4.6)),
    "a box made normal": Case(Uniform(), TruncatedNormal(mean=4.4, deviation=0.2), ((BELOW, 4.1),), 1000),
    "another shape": Case(Beta(alpha=2.0, beta=4.0), Beta(alpha=2.0, beta=5.0), ((BELOW, 4.2),), 1000),
}
"""One region violates."""

PAIRS: dict[str, Case] = {
    "a shift by 1.5 deviations; the middle, and a tail": Case(
        _normal(4.8), _normal(5.1), ((4.78, 4.82), (5.4, ABOVE)), 1000
    ),
    "a shift by 1.2 deviations; the middle, and a tail": Case(
        _normal(4.8), _normal(5.04), ((4.78, 4.82), (5.4, ABOVE)), 1000
    ),
    "a shift by one deviation; the middle, and a tail": Case(
        _normal(5.0), _normal(5.2), ((4.96, 5.04), (5.54, ABOVE)), 500
    ),
    "a shift by one deviation; all but the middle and a tail": Case(
        _normal(5.0), _normal(5.2), ((4.96, 5.04), (5.54, ABOVE)), 500, others=True
    ),
    "a wider one; the middle, and a tail": Case(_normal(5.0), _normal(5.0, 0.26), ((4.98, 5.02), (5.58, ABOVE)), 1000),
    "a triangle made uniform; the middle, and an end": Case(
        Triangular(mode=5.0), Uniform(), ((4.9, 5.1), (BELOW, 4.05)), 3000
    ),
    "a box made steep; the middle, and an end": Case(
        Uniform(), Beta(alpha=0.5, beta=0.5), ((4.9, 5.1), (BELOW, 4.004)), 1000
    ),
    "another shape; the middle, and an end": Case(
        Beta(alpha=2.0, beta=4.0), Beta(alpha=2.0, beta=6.0), ((4.9, 4.95), (BELOW, 4.05)), 1000
    ),
}
"""Two regions violate: one with many draws, and one with few, where the moved distribution has most of its weight."""


def random_pairs(count: int, seed: int) -> Iterator[Case]:
    """Moves, places and numbers of draws at random; where the ratio of densities is highest, a region of 0.3 to 10
    draws."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        kinds = _moves(random)[random.integers(6)]
        draws = int(random.choice([300, 1000, 3000]))
        stated, moved = law(kinds[0]), law(kinds[1])
        probability = float(np.exp(random.uniform(np.log(0.01), np.log(0.5))))
        first = 0.05 + (0.9 - probability) * random.random()
        wide, off = np.exp(random.uniform(np.log(0.3), np.log(10.0))), random.choice([0.0, 1.0, 4.0, 10.0])
        second = np.array([off, off + wide]) / draws
        ends = [float(moved.pdf(x) / stated.pdf(x)) for x in stated.ppf([1e-3, 1.0 - 1e-3])]
        second = second if ends[0] > ends[1] else 1.0 - second[::-1]
        low, high = stated.ppf([first, second[0]]), stated.ppf([first + probability, second[1]])
        regions = ((float(low[0]), float(high[0])), (float(low[1]), float(high[1])))
        yield Case(*kinds, regions, draws, others=bool(random.random() < 0.3))


def _moves(random: np.random.Generator) -> list[tuple[Distribution, Distribution]]:
    shift, factor = random.uniform(-0.3, 0.3), random.uniform(1.1, 1.35)

    def normal(mean: float, deviation: float = 0.2) -> TruncatedNormal:
        return TruncatedNormal(mean=mean, deviation=deviation)

    return [
        (normal(5.0), normal(5.0 + shift)),
        (normal(5.0), normal(5.0 + shift)),
        (normal(5.0), normal(5.0, 0.2 * factor)),
        (Beta(alpha=2.0, beta=4.0), Beta(alpha=2.0, beta=4.0 + 10.0 * abs(shift))),
        (Triangular(mode=5.0), Triangular(mode=5.0 + 3.0 * shift)),
        (Uniform(), Beta(alpha=1.0 - 1.5 * abs(shift), beta=1.0)),
    ]
