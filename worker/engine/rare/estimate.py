"""P(violation) by importance sampling over the modes of known violations, with its interval and the alarms.

Importance sampling at the design points of several modes: Tabandeh, Jia, Gardoni, A review and assessment of importance
sampling methods for reliability analysis (Structural Safety 97, 2022), section 3. The estimate takes draws that nothing
was adapted to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from worker.engine.rare import hidden
from worker.engine.rare.alarms import NOTHING, Alarm, Counts, alarms, effective
from worker.engine.rare.design import cost
from worker.engine.rare.evaluated import Allowance, Asking, Bools, Evaluated, Floats, evaluated
from worker.engine.rare.explained import examined, explained
from worker.engine.rare.interval import Interval, interval
from worker.engine.rare.known import Known
from worker.engine.rare.mixture import Mixture

INDEPENDENT, WIDE, ADAPTING, FINAL = 0.06, 0.03, 0.05, 0.33
"""Fractions of the budget: the independent sample, each wider one, each of the rounds, the least for the estimate."""
ROUNDS = 3
LEAST_BUDGET = 1000
MOST_PARAMETERS = 20
"""With 40 parameters, an interval was measured not to hold; `tests.bench.rare` has problems of up to 20."""


@dataclass(frozen=True)
class Mode:
    """One mode: its design point in standard normal space, its share of P, and the violations that led to it.

    origins: numbers of the given violations, the stored ones after the starts; None where the search for hidden modes
    found it.
    """

    design: Floats
    share: float
    origins: tuple[int, ...] | None


@dataclass(frozen=True)
class Estimate:
    """The result: with an alarm the interval must not be shown as one that holds.

    effective: effective sample size of the violations of the estimate; drawn: its evaluations, the last that were
    requested, from the mixture; sampled: how many were requested before the independent sample, and its size.
    """

    interval: Interval
    modes: tuple[Mode, ...]
    effective: float
    drawn: int
    failed: int
    alarms: tuple[Alarm, ...]
    mixture: Mixture
    sampled: tuple[int, int]


@dataclass(frozen=True)
class Refused:
    """Why there is no estimate; limit: the least budget, or the most parameters."""

    why: Literal["no_violation", "too_far", "budget", "parameters"]
    limit: int = 0


def without_far(made: Estimate | Refused, moved: Bools) -> Estimate | Refused:
    """The refusal with its reason where no start violates because some were moved from farther in a tail."""
    return Refused("too_far") if made == Refused("no_violation") and moved.any() else made


def estimated(
    violations: Floats,
    threshold: float,
    budget: int,
    random: np.random.Generator,
    confidence: float = 0.95,
    inside: Callable[[Floats], Bools] = lambda points: np.ones(len(points), dtype=bool),
    stored: Floats | None = None,
    certified: Counts = NOTHING,
) -> Asking[Estimate | Refused]:
    """The estimate from violations (k, n) in standard normal space, in this order, in `budget` evaluations.

    The search for modes counts points that are not inside like any other, the estimate as no violations. stored: all
    known violations (m, n), of which those of no known mode are examined; certified: of the run's independent sample.
    """
    allowed = Allowance(threshold, budget)
    rounds, keep = int(ADAPTING * budget), int(FINAL * budget) + ROUNDS * int(ADAPTING * budget)
    started = yield from _started(violations, allowed, keep, stored)
    if isinstance(started, Refused):
        return started
    known, left = started
    n = violations.shape[1]
    sampled = budget - allowed.left, int(INDEPENDENT * budget)
    sample = yield from evaluated(random.standard_normal((sampled[1], n)), allowed)
    left += yield from hidden.searched(sample, known, random, allowed, int(WIDE * budget), keep)
    mixture = yield from _adapted(Mixture.of(known.designs), random, rounds, allowed)
    seen = yield from evaluated(mixture.draws(random, allowed.left), allowed)
    seen, sample = (of.counted(inside(of.points)) for of in (seen, sample))
    weights = np.exp(-mixture.log_ratio(seen.points))
    found = interval(weights, seen, sample, confidence)
    terms = np.where(seen.violates & (found.probability > 0.0), weights, 0.0)
    return Estimate(
        found,
        _modes(known, mixture, seen, terms),
        effective(terms),
        len(terms),
        int(np.count_nonzero(seen.failed)),
        alarms(terms, found, sample, known, left, certified),
        mixture,
        sampled,
    )


def _started(
    violations: Floats, allowed: Allowance, keep: int, stored: Floats | None
) -> Asking[tuple[Known, int] | Refused]:
    """The modes of the given violations, and how many have none; points that do not violate are passed over."""
    n = violations.shape[1]
    if n > MOST_PARAMETERS:
        return Refused("parameters", MOST_PARAMETERS)
    others = int((INDEPENDENT + len(hidden.DEVIATIONS) * WIDE) * allowed.left)
    needed = int(np.ceil((2 * cost(n) + len(violations)) * allowed.left / max(allowed.left - keep - others, 1)))
    if allowed.left < max(needed, LEAST_BUDGET):
        return Refused("budget", max(needed, LEAST_BUDGET))
    seen = yield from evaluated(violations, allowed)
    if not (seen.violates & ~seen.failed).any():
        return Refused("no_violation")
    known = Known.none(n)
    left = yield from explained(violations[seen.violates], known, allowed, keep + others, origins=True)
    numbers = np.flatnonzero(seen.violates)
    known.origins = [None if own is None else numbers[own].tolist() for own in known.origins]
    if stored is not None:
        left += yield from examined(stored, violations, known, allowed, keep + others)
    return known, left


def _adapted(mixture: Mixture, random: np.random.Generator, count: int, allowed: Allowance) -> Asking[Mixture]:
    """The mixture after all rounds; every round is fitted to the draws of all rounds so far."""
    used: list[Mixture] = []
    pool: Evaluated | None = None
    for _ in range(ROUNDS):
        seen = yield from evaluated(mixture.draws(random, count), allowed)
        pool = seen if pool is None else pool.then(seen)
        used.append(mixture)
        bad = pool.points[pool.violates]
        density = np.mean([np.exp(one.log_ratio(bad)) for one in used], axis=0)
        mixture = mixture.adapted(bad, 1.0 / density)
    return mixture


def _modes(known: Known, mixture: Mixture, seen: Evaluated, terms: Floats) -> tuple[Mode, ...]:
    """The modes with their shares: each violation counts for the modes by their responsibility for it."""
    shares = terms @ mixture.responsible(seen.points) / max(terms.sum(), 1e-300)
    return tuple(
        Mode(design, float(share), None if origins is None else tuple(origins))
        for design, share, origins in zip(known.designs, shares, known.origins, strict=True)
    )
