"""Estimates under moved distributions, from the independent sample of a run: `reweighted`. Nothing is evaluated.

Self-normalised importance sampling: Owen, Monte Carlo theory, methods and examples, 2013, section 9.2. Effective sample
size: Kish, Survey Sampling, 1965. Interval: Korn and Graubard, Survey Methodology 24, 1998, that of Clopper and Pearson
with the effective number of draws, and wider by what the draws can have `missed`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns import rules
from campaigns.claims import reweighted as claims
from campaigns.claims.spans import Spans
from campaigns.cube import Floats
from campaigns.densities.joint import Joint
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.reweighted import EstimatedQuantile, Reweighted
from campaigns.special import beta_quantile

NEEDED = 100
"""The smallest effective sample size for an estimate."""
TRIALS, SEED = 2**14, 1
"""Points of the moved distributions for what is expected of the weights, always the same."""
FEW = 10
"""With fewer effective draws below a quantile, too little is known of the weights there."""
ROUNDING = 1e-9
"""Of a sum of weights, and of a bound as a fraction of its range."""
REDRAWN = 1e-3
"""The largest probability of a correlated draw that was moved inside the bounds."""


class Drawn(NamedTuple):
    """The draws of an independent sample, excluded ones included: points (m, n), deciding costs (m,), status (m,)."""

    points: Floats
    costs: Floats
    status: NDArray[np.uint8]


class Terms(NamedTuple):
    """What is estimated: P(cost <= threshold), with this confidence, and quantiles of these fractions."""

    threshold: float
    confidence: float
    shares: Sequence[float]


def reweighted(stated: Joint, moved: Joint, drawn: Drawn, terms: Terms) -> Reweighted:
    """The estimate under `moved` from draws of `stated`; without numbers where it is refused."""
    counted = drawn.status != EXCLUDED
    every = _scaled(log_ratio(stated, moved, stated.values(drawn.points)))
    costs, weights = np.where(drawn.status == OK, drawn.costs, -math.inf)[counted], every[counted]
    trials = moved.values(moved.drawn(np.random.default_rng(SEED).random((TRIALS, len(moved.shapes)))))
    ratios = log_ratio(stated, moved, trials)
    found = Reweighted(
        samples=len(costs),
        violations=int(np.count_nonzero(costs <= terms.threshold)),
        failed=int(np.count_nonzero(np.isneginf(costs))),
        excluded=int(np.count_nonzero(~counted)),
        effective=effective(weights, ratios),
        needed=NEEDED,
        outside=moved.outside,
        confidence=terms.confidence,
    )
    at_bound = [*stated.rounded(stated.values(drawn.points)), *stated.rounded(trials), *moved.rounded(trials)]
    if refusal := _refused(stated, moved, found, at_bound):
        return found.model_copy(update={"statement": refusal})
    kept = float(weights.sum() / every.sum())
    return _estimated(found, _Weighted(weights / weights.sum(), costs, ratios, kept), terms)


def without(reason: Spans, confidence: float) -> Reweighted:
    """What is stated where there are no draws."""
    nothing = dict.fromkeys(("samples", "violations", "failed", "excluded", "effective", "outside"), 0)
    return Reweighted.model_validate(nothing | {"needed": NEEDED, "confidence": confidence, "statement": reason})


class _Weighted(NamedTuple):
    """shares: weights of the counted draws, whose sum is 1; ratios: of trials; kept: the weight not excluded."""

    shares: Floats
    costs: Floats
    ratios: Floats
    kept: float


def log_ratio(stated: Joint, moved: Joint, values: Floats) -> Floats:
    """The logarithm of the ratio of the two densities at each point; minus infinity where the moved one is zero."""
    under, over = stated.log_density_at(values), moved.log_density_at(values)
    known = np.isfinite(under)
    return np.where(known, over - np.where(known, under, 0.0), -math.inf)


def _scaled(logarithms: Floats) -> Floats:
    """Weights up to a factor, so that none is too large."""
    top = float(logarithms.max(initial=-math.inf))
    return np.exp(logarithms - top) if math.isfinite(top) else np.zeros(len(logarithms))


def effective(weights: Floats, ratios: Floats) -> float:
    """Kish's effective sample size, as observed and as expected, whichever is lower; ratios: `log_ratio` of trials.

    What is observed is too large where the draws miss the largest weights. The mean weight under the moved
    distributions is the mean square under the stated ones.
    """
    if not len(ratios):
        return 0.0
    expected = len(weights) / float(np.exp(np.clip(ratios, None, 700.0)).mean())
    return min(_kish(weights), expected, float(len(weights)))


def _kish(weights: Floats) -> float:
    return float(weights.sum() ** 2 / (weights**2).sum()) if weights.any() else 0.0


def _refused(stated: Joint, moved: Joint, found: Reweighted, at_bound: list[str]) -> Spans:
    """Why there is no estimate; empty if there is one. at_bound: parameters with draws rounded to a bound where the
    density is unbounded."""
    ceiling, slack = rules.CEILING.value, ROUNDING * (stated.high - stated.low)
    beyond = (moved.low < stated.low - slack) | (moved.high > stated.high + slack)
    if wider := [path for path, one in zip(stated.shapes, beyond, strict=True) if one]:
        return claims.beyond(wider)
    if moved.outside > ceiling:
        return claims.outside(moved.outside, ceiling)
    if at_bound:
        return claims.at_bound(list(dict.fromkeys(at_bound)))
    redrawn = sum(one.outside for k, one in enumerate(stated.shapes.values()) if k in stated.mixed)
    if redrawn > REDRAWN:
        return claims.redrawn(redrawn)
    return claims.too_few(found.effective, found.samples, NEEDED) if found.effective < NEEDED else ()


def _estimated(found: Reweighted, of: _Weighted, terms: Terms) -> Reweighted:
    violate = of.costs <= terms.threshold
    p = min(float(of.shares[violate].sum()), 1.0)
    low, high = interval(p, of.shares, violate, found.effective, terms.confidence)
    # Of the draws outside the bounds none may be excluded, whereas of those within some are.
    outside = min(1.0, found.outside / of.kept)
    unseen = missed(found, of.ratios, of.kept)
    for unknown in (unseen, outside):
        low, high = low * (1.0 - unknown), high * (1.0 - unknown) + unknown
    draws = claims.Draws(found.samples, found.failed, found.excluded, found.effective, outside, unseen)
    statement = claims.estimate(p, (low, high), terms.confidence, draws)
    quantiles = _quantiles(of.shares, of.costs, terms.shares)
    estimates = {"probability": p, "low": low, "high": high, "quantiles": quantiles, "statement": statement}
    return found.model_copy(update=estimates)


def interval(
    p: float, shares: Floats, violate: NDArray[np.bool_], most: float, confidence: float
) -> tuple[float, float]:
    """Korn and Graubard's two-sided interval of a weighted fraction p.

    shares: weights whose sum is 1; most: the largest effective number of draws.
    """
    variance = float((shares**2 * (violate - p) ** 2).sum())
    n = min(most, p * (1.0 - p) / variance) if variance > 0.0 else most
    return _clopper_pearson(n * p, n, confidence)


def _clopper_pearson(events: float, draws: float, confidence: float) -> tuple[float, float]:
    tail = (1.0 - confidence) / 2.0
    low = beta_quantile(tail, events, draws - events + 1.0) if events > 0.0 else 0.0
    high = beta_quantile(1.0 - tail, events + 1.0, draws - events) if events < draws else 1.0
    return low, high


def missed(found: Reweighted, ratios: Floats, kept: float) -> float:
    """The probability that the draws can have missed, beyond what the interval of Korn and Graubard counts.

    For any violating region V, with half of the error at each end: let c = log(2 / (1 - confidence)). n draws miss a
    region of stated probability c / n with probability exp(-c). Let T be the part of V with the highest ratios that has
    this stated probability, or all of V. Its moved probability is at most `highest`, which is added: T needs no draw.
    The rest of V has no higher ratios, and the draws of T are c more than are needed for it. The upper limit for a
    Poisson number k of draws is above k + z sqrt(k) by c if k = 0 and by less otherwise (Garwood, Biometrika 28, 1936),
    so these c draws are what a normal interval lacks; a test has pairs of ratios. The lower end is one minus the upper
    one of what does not violate. The interval of Clopper and Pearson has c effective draws of it already.

    kept: the weight that is not excluded.
    """
    expected = math.log(2.0 / (1.0 - found.confidence))
    most = highest(expected / (found.samples + found.excluded), ratios) / kept - expected / found.effective
    return min(most, 1.0) if most > ROUNDING else 0.0


def highest(stated: float, ratios: Floats) -> float:
    """The highest moved probability of all regions with this stated one; ratios: `log_ratio` of trials.

    It is that of the region with the highest ratio of densities (Neyman and Pearson, Phil. Trans. R. Soc. A 231, 1933).
    """
    inverse = np.sort(np.exp(-np.clip(ratios, -700.0, 700.0))) / len(ratios)
    share = np.arange(len(ratios) + 1) / len(ratios)
    return float(np.interp(stated, np.concatenate([[0.0], np.cumsum(inverse)]), share))


def _quantiles(shares: Floats, costs: Floats, wanted: Sequence[float]) -> list[EstimatedQuantile]:
    """The quantiles of the stored draws; a value of None where few draws are below it."""
    order = np.argsort(costs, kind="stable")
    below, found = np.cumsum(shares[order]), list[EstimatedQuantile]()
    for share in wanted:
        k = min(int(np.searchsorted(below, share - ROUNDING)), len(order) - 1)
        at, known = float(costs[order[k]]), _kish(shares[order[: k + 1]]) >= FEW
        found.append(EstimatedQuantile(share=share, value=at if known and math.isfinite(at) else None))
    return found
