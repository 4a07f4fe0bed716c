"""Statements on a random sample: counts, the bound on P(violation), a quantile bound, the distribution function.

A failed evaluation counts as a violation and as the lowest value, because its outcome is unknown. If the distributions
extend beyond the bounds, that probability is added to the bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from campaigns.claims.say import count, listed, number, percent, say, symbol
from campaigns.claims.spans import Spans, words
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.sample import Distribution, Histogram, QuantileBound
from campaigns.results.sample import Noise as NoiseKind
from campaigns.results.sample import Sample as Statement
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Method
from worker.engine.stages.parts import claims, noise
from worker.engine.stages.parts.base import Context
from worker.engine.stages.parts.store import Columns
from worker.engine.systems.base import Floats, Realised

STEPS = 400
"""Points of the distribution function in a chart."""


@dataclass(frozen=True)
class Noise:
    """The realisations of the scenario's noise that a statement holds for.

    kind: none (no noise), drawn (one for every sample), stated (those that the campaign lists); clause: as text;
    holds: what the statement is of, and which condition it needs.
    """

    kind: NoiseKind = "none"
    clause: str = ""
    holds: str = ""

    @staticmethod
    def given(realised: Realised) -> Noise:
        """The noise of evaluations that all simulate the realisations stated in the campaign."""
        if not realised.random:
            return Noise()
        seeds = words(listed([str(seed) for seed in realised.seeds]))
        which = f"the {realised.combine} of seeds {seeds}" if realised.several else f"seed {seeds}"
        return Noise("stated", f", for the stated noise only ({which})")

    @staticmethod
    def of_calls(context: Context, single: bool) -> Noise | None:
        """The noise of a simulator that does not repeat, evaluated by single calls or combined as the campaign states;
        None for any other system."""
        simulator = context.campaign.simulator
        if simulator is None or not noise.noisy(context):
            return None
        if single or simulator.calls == 1:
            return CALLED
        return Noise("stated", f", where each evaluation is the {simulator.combine} of {simulator.calls} calls")


DRAWN = Noise("drawn", ", each with its own noise realisation,")
CALLED = Noise(
    "drawn", ", each by one call of the simulator,", ", over parameters and noise, if the noise of calls is independent"
)


@dataclass(frozen=True)
class Sample:
    """Independent draws that were simulated: their sorted costs; how many failed; how many were excluded."""

    costs: Floats
    failed: int
    excluded: int
    threshold: float
    outside: float
    """The probability beyond the bounds, or an upper bound on it."""
    confidence: float
    noise: Noise = Noise()

    @staticmethod
    def of(columns: Columns, problem: Problem, confidence: float, noise: Noise | None = None) -> Sample:
        """The sample of these evaluations, by default under the realisations stated in the campaign."""
        costs = np.sort(columns.costs[columns.status == OK, 0])
        excluded = int(np.count_nonzero(columns.status == EXCLUDED))
        failed = len(columns.status) - excluded - len(costs)
        noise = noise or Noise.given(problem.realisations)
        outside = problem.distributions.outside
        return Sample(costs, failed, excluded, problem.threshold, outside, confidence, noise)

    @property
    def size(self) -> int:
        return len(self.costs) + self.failed

    @property
    def violations(self) -> int:
        return int(np.count_nonzero(self.costs <= self.threshold)) + self.failed

    def statement(self, level: float | None = None) -> Statement:
        """Counts, moments, histogram and the bound on P(violation), whose own `level` may be stricter."""
        costs = self.costs
        upper = min(1.0, claims.bound(self.violations, self.size, level or self.confidence) + self.outside)
        counts, edges = np.histogram(costs, bins=min(40, max(5, int(np.sqrt(len(costs))))))
        return Statement(
            samples=self.size,
            violations=self.violations,
            failed=self.failed,
            excluded=self.excluded,
            outside=self.outside,
            confidence=self.confidence,
            upper_bound=upper,
            excluded_fraction=self.excluded_fraction,
            noise=self.noise.kind,
            lowest=float(costs[0]) if len(costs) else None,
            mean=float(costs.mean()) if len(costs) else None,
            deviation=float(costs.std(ddof=1)) if len(costs) > 1 else None,
            histogram=Histogram(edges=edges.tolist(), counts=counts.tolist()),
            statement=say(
                *(self._seen(), self.violate(), ": P(violation) is at most "),
                *(percent(upper, name="upper_bound"), " with ", percent(self.confidence, 6, "confidence")),
                *(" confidence", self._beyond(), self._conditions()),
            ),
        )

    def unclaimed(self, points: str, why: str) -> Statement:
        """The statement without a bound, and the reason for that."""
        estimate = say(" (an estimate of ", percent(self.violations / self.size), ")") if self.size else ()
        statement = say(
            *(count(self.violations, "violations"), " of ", count(self.size, "samples"), f" {points}"),
            *(self.violate(), estimate, f": {why}", self._conditions()),
        )
        return self.statement().model_copy(update={"upper_bound": None, "statement": statement})

    def quantile(self, share: float, quantity: str, unit: str) -> QuantileBound:
        """Wilks' lower bound on the quantile at `share`: which of the lowest values, with which confidence."""
        within = share - self.outside
        counted = ", counted over all draws," if self.outside and self.excluded else ""
        r = claims.order(self.size, within, self.confidence)
        least = claims.needed(within, self.confidence) if within > 0.0 else None
        value = float(self.costs[r - 1 - self.failed]) if r > self.failed else None
        most, size, none = percent(share, 6, "share"), count(self.size, "samples"), "no bound on the "
        if least is None:
            statement = say(none, most, " quantile: ", percent(self.outside), " of the draws may be beyond the bounds")
        elif r == 0:
            few = " samples are too few for a bound on the "
            statement = say(size, few, most, " quantile, which needs ", count(least, "needed"))
        elif value is None:
            statement = say(none, most, f" quantile: the {_ordinal(r)} lowest of the sample is a failed evaluation")
        else:
            statement = say(
                *("at most ", most, f" of all cases{counted} have ", symbol(quantity), " below "),
                *(number(value, unit, "bound"), ", with ", percent(self.confidence, 6, "confidence")),
                *(f" confidence: this is the {_ordinal(r)} lowest of ", size),
            )
        confidence = claims.held(r, self.size, within) if r else None
        return QuantileBound(
            share=share, order=r or None, bound=value, needed=least, confidence=confidence, statement=statement
        )

    def distribution(self) -> Distribution:
        """The empirical distribution function: values and the fraction of the sample at or below each; its band."""
        size = len(self.costs)
        # All of the lowest values, and evenly spaced ones of the rest.
        lowest = np.arange(min(size, STEPS // 4))
        chosen = np.union1d(lowest, np.linspace(0, size - 1, min(size, STEPS)).astype(np.int64))
        shares = (self.failed + np.arange(1, size + 1)) / max(self.size, 1)
        return Distribution(
            values=[float(self.costs[i]) for i in chosen],
            shares=[float(shares[i]) for i in chosen],
            band=claims.band(self.size, self.confidence),
        )

    @property
    def excluded_fraction(self) -> float:
        """The fraction of all draws that were excluded."""
        return self.excluded / max(self.size + self.excluded, 1)

    def _seen(self) -> Spans:
        own = self.noise.clause if self.noise.kind == "drawn" else ""
        drawn = f" samples drawn from the stated distributions{own}"
        return say(count(self.violations, "violations"), " of ", count(self.size, "samples"), drawn)

    def _conditions(self) -> Spans:
        """The conditions under which the statement holds: noise and exclusions."""
        given = self.noise.clause if self.noise.kind == "stated" else self.noise.holds
        if not self.excluded:
            return say(given)
        return say(
            *(f"{given}; it holds only for starts above the threshold: ", count(self.excluded, "draws_excluded")),
            *(" of ", count(self.size + self.excluded, "draws"), " draws (", percent(self.excluded_fraction)),
            ") start at or below it and were excluded",
        )

    def violate(self) -> Spans:
        """The verb of the violations, which says how many of them failed, if any."""
        if not self.failed:
            return say(" violate the criterion")
        return say(" violate the criterion or failed (", count(self.failed, "draws_failed"), " failed)")

    def _beyond(self) -> Spans:
        if not self.outside:
            return ()
        every = ", relative to all draws, including excluded ones" if self.excluded else ""
        beyond = f" is the probability beyond the bounds{every}"
        return say(", of which ", percent(self.outside, name="outside"), beyond)


def of_search(context: Context, method: Method, options: Any, columns: Columns) -> Statement:
    """The statement of a random search: a bound only if its points are independent; with early stopping, one that
    allows for the interim analyses."""
    confidence = context.campaign.confidence
    sample = Sample.of(columns, context.problem, confidence, Noise.of_calls(context, single=False))
    drawn = method.sampling(options, len(columns.status), confidence)
    if drawn.barred:
        return sample.unclaimed(drawn.points, drawn.barred)
    statement = sample.statement(drawn.level)
    if drawn.level is None:
        return statement
    how = say(
        "; early stopping spends the error over interim analyses (alpha spending), so all their bounds hold together; "
        "this is interim analysis ",
        *(count(drawn.looks, "looks"), ", at ", percent(drawn.level, 6, "level")),
    )
    return statement.model_copy(update={"looks": drawn.looks, "statement": say(statement.statement, how)})


def _ordinal(r: int) -> str:
    ending = "th" if r % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(r % 10, "th")
    return f"{r}{ending}"
