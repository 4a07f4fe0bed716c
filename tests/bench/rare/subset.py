"""Subset simulation next to the estimate, at equal evaluations: `python -m tests.bench.rare --subset`.

Au and Beck, Estimation of small failure probabilities in high dimensions by subset simulation (Probabilistic
Engineering Mechanics 16, 2001), with the conditional sampling of Papaioannou, Betz, Zwirglmaier and Straub, MCMC
algorithms for subset simulation (Probabilistic Engineering Mechanics 41, 2015), algorithm 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.bench.rare.judge import BUDGET, LARGE, Outcome, outcome
from tests.bench.rare.problem import Floats, Problem

PART, CORRELATION = 0.1, 0.8
"""The probability of a level given the one before; of a candidate with the state before it."""
LEVELS = 12
ABOVE = 2.0
"""Times the upper end of the estimate's interval: from there on it contradicts the estimate."""


@dataclass(frozen=True)
class Subset:
    """Its probability, and the violations (k, n) of its last level; nan and none if the levels did not suffice."""

    probability: float
    violations: Floats
    evaluations: int


def subset(problem: Problem, each: int, random: np.random.Generator) -> Subset:
    """With `each` evaluations of a level."""
    points = random.standard_normal((each, problem.dimension))
    costs, probability, spent = problem.costs(points), 1.0, each
    for _ in range(LEVELS):
        level = float(np.quantile(costs, PART))
        if level <= 0.0:
            break
        probability *= PART
        seeds = np.argsort(costs, kind="stable")[: int(PART * each)]
        chains, of = [points[seeds]], [costs[seeds]]
        while len(chains) < round(1.0 / PART):
            near = random.standard_normal(chains[-1].shape)
            tried = CORRELATION * chains[-1] + np.sqrt(1.0 - CORRELATION**2) * near
            values = problem.costs(tried)
            spent += len(tried)
            kept = values <= level
            chains.append(np.where(kept[:, None], tried, chains[-1]))
            of.append(np.where(kept, values, of[-1]))
        points, costs = np.concatenate(chains), np.concatenate(of)
    else:
        return Subset(float("nan"), points[:0], spent)
    return Subset(probability * float(np.mean(costs <= 0.0)), points[costs <= 0.0], spent)


def equal(problem: Problem, seed: int) -> Subset:
    """With the levels as large as the budget of the estimate allows."""
    each = BUDGET // 6
    for _ in range(4):
        found = subset(problem, each, np.random.default_rng([seed, each, *problem.name.encode()]))
        if found.evaluations <= BUDGET and not np.isnan(found.probability):
            break
        each = max(50, int(0.95 * each * BUDGET / found.evaluations))
    return found


def measured(problems: Sequence[Problem], seeds: Sequence[int]) -> dict[str, Any]:
    """Its errors; the modes of a tenth of P that its violations reach; of those that were withheld from the estimate
    and missed without an alarm, how many it reaches or shows, and the estimate itself notices with as many evaluations
    again."""
    errors, large = list[float](), list[bool]()
    missed, whole = list[tuple[bool, bool, bool]](), list[bool]()
    for problem in problems:
        withheld = [k for k, m in enumerate(problem.modes) if m.probability > LARGE * problem.probability]
        for seed in seeds:
            found = equal(problem, seed)
            errors.append(found.probability / problem.probability)
            made = outcome(problem, None, seed)
            whole.append(_above(found, made, problem) and not made.alarms)
            for mode in withheld:
                reached = bool((problem.modes[mode].limit(found.violations) <= 0.0).any())
                large.append(reached)
                made = outcome(problem, mode, seed) if len(problem.modes) > 1 else made
                if len(problem.modes) > 1 and not made.found and not made.alarms:
                    more = outcome(problem, mode, seed, 2 * BUDGET)
                    missed.append((reached, _above(found, made, problem), more.found or bool(more.alarms)))
                    print(f"  {problem.name}, withheld {made.withheld:.0%}: reached, contradicted, twice: {missed[-1]}")
    known = np.array([error for error in errors if not np.isnan(error)])
    result = {
        "runs": len(errors),
        "without_result": len(errors) - len(known),
        "median_ratio": float(np.median(known)),
        "within_factor_two": float(np.mean(np.abs(np.log2(known)) <= 1.0)),
        "large_modes": len(large),
        "large_reached": float(np.mean(large)),
        "missed_by_estimate": len(missed),
        **dict(zip(("reached", "contradicted", "noticed_with_twice"), np.sum(missed, axis=0).tolist(), strict=False)),
        "contradicted_wrongly": float(np.mean(whole)),
    }
    print(" ".join(f"{name} {value:.4g}" for name, value in result.items()))
    return result


def _above(found: Subset, made: Outcome, problem: Problem) -> bool:
    return found.probability > ABOVE * made.high * problem.probability
