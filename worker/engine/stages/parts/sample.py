"""What a random sample shows: counts, the bound on P(violation), a quantile bound, the distribution function.

A failed evaluation counts as a violation and as the lowest value, because its outcome is unknown. If the distributions
extend beyond the bounds, that probability is added to the bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from campaigns.claims.stages import sample as sentences
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.sample import Distribution, QuantileBound
from campaigns.results.sample import Noise as NoiseKind
from campaigns.results.sample import Sample as Statement
from campaigns.sample_seed import SampleSeed
from campaigns.stored.blocks import Counted
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.search.base import Method
from worker.engine.stages.parts import claims, noise
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.shape import Binned, Ordered, Shape
from worker.engine.systems import optional
from worker.engine.systems.base import Realised


@dataclass(frozen=True)
class Noise:
    """The realisations of the scenario's noise that a statement holds for.

    kind: none (no noise), drawn (one for every sample), stated (those that the campaign lists); terms: in words.
    """

    kind: NoiseKind = "none"
    terms: sentences.Terms = sentences.WITHOUT

    @staticmethod
    def stated(realised: Realised) -> Noise:
        """The noise of evaluations that all simulate the realisations stated in the campaign."""
        return Noise("stated", sentences.stated(realised.combine, realised.seeds)) if realised.random else Noise()

    @staticmethod
    def of_calls(context: Context, single: bool) -> Noise | None:
        """The noise of a simulator that does not repeat, evaluated by single calls or combined as the campaign states;
        None for any other system."""
        simulator = context.campaign.simulator
        if simulator is None or not noise.noisy(context):
            return None
        if single or simulator.calls == 1:
            return Noise("drawn", sentences.CALLED)
        return Noise("stated", sentences.combined(simulator.combine, simulator.calls))


DRAWN = Noise("drawn", sentences.DRAWN)


@dataclass(frozen=True)
class Sample:
    """Independent draws that were simulated: the shape of their costs; how many violate, failed, were excluded."""

    shape: Shape
    violations: int
    """Those that failed among them."""
    failed: int
    excluded: int
    outside: float
    """The probability beyond the bounds, or an upper bound on it."""
    confidence: float
    noise: Noise = Noise()
    simulator: bool = False
    """Whether it is of a simulator, which may exclude draws for reasons of its own."""
    seed: str = ""
    """Which seed it has, in words; empty if it was drawn at the launch."""
    redrawn: float = 0.0
    """An upper bound on the probability that a draw was moved inside the bounds."""
    own_rule: bool = False
    """Whether it is of a criterion that excludes draws by a rule of its own."""

    @staticmethod
    def of(columns: Columns, problem: Problem, confidence: float, noise: Noise | None = None, seed: str = "") -> Sample:
        """The sample of these evaluations, by default under the realisations stated in the campaign."""
        costs = np.sort(columns.costs[columns.status == OK, 0])
        excluded = int(np.count_nonzero(columns.status == EXCLUDED))
        failed = len(columns.status) - excluded - len(costs)
        violations = int(np.count_nonzero(costs <= problem.threshold)) + failed
        return _sample(Ordered(costs), (violations, failed, excluded), problem, confidence, noise, seed)

    @staticmethod
    def of_counted(
        counted: Counted, problem: Problem, confidence: float, noise: Noise | None = None, seed: str = ""
    ) -> Sample:
        """The sample of which only the lowest flights are kept."""
        counts = counted.violations, counted.failed, counted.excluded
        return _sample(Binned(counted), counts, problem, confidence, noise, seed)

    @property
    def size(self) -> int:
        return self.shape.known + self.failed

    @property
    def counts(self) -> sentences.Counts:
        """What its sentences state."""
        numbers = self.violations, self.size, self.failed, self.excluded, self.outside, self.confidence
        return sentences.Counts(*numbers, self.noise.terms, self.simulator, self.seed, self.own_rule)

    def statement(self, level: float | None = None, counted: int | None = None) -> Statement:
        """Counts, moments, histogram and the bound on P(violation), whose own `level` may be stricter.

        counted: how many samples the bound counts, if not all.
        """
        size = self.size if counted is None else counted
        upper = min(1.0, claims.bound(self.violations, size, level or self.confidence) + self.outside)
        mean, deviation = self.shape.moments
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
            lowest=self.shape.lowest,
            mean=mean,
            deviation=deviation,
            histogram=self.shape.histogram(),
            bound_samples=counted,
            statement=self.counts.bound(upper),
        )

    def unclaimed(self, points: str, why: str) -> Statement:
        """The statement without a bound, and the reason for that."""
        statement = self.counts.unclaimed(points, why)
        return self.statement().model_copy(update={"upper_bound": None, "statement": statement})

    def quantile(self, share: float, quantity: str, unit: str) -> QuantileBound:
        """Wilks' lower bound on the quantile at `share`: which of the lowest values, with which confidence."""
        within = share - self.outside
        r = claims.order(self.size, within, self.confidence)
        least = claims.needed(within, self.confidence)
        value = self.shape.value(r - self.failed) if r > self.failed else None
        statement = self.counts.quantile(share, quantity, unit, r, least, value)
        confidence = claims.confidence_of(r, self.size, within) if r else None
        return QuantileBound(
            share=share, order=r or None, bound=value, needed=least, confidence=confidence, statement=statement
        )

    def distribution(self) -> Distribution:
        """The empirical distribution function: values and the fraction of the sample at or below each; its band.

        Where draws are excluded, the fraction of the others that were moved inside the bounds is not known.
        """
        values, ranks = self.shape.curve()
        redrawn = 1.0 if self.redrawn > 0.0 and self.excluded else self.redrawn
        return Distribution(
            values=values,
            shares=[(self.failed + rank) / max(self.size, 1) for rank in ranks],
            band=claims.band(self.size, self.confidence, redrawn),
        )

    @property
    def excluded_fraction(self) -> float:
        """The fraction of all draws that were excluded."""
        return self.excluded / max(self.size + self.excluded, 1)


def _sample(
    shape: Shape, counts: tuple[int, int, int], problem: Problem, confidence: float, noise: Noise | None, seed: str
) -> Sample:
    simulator, drawn = problem.campaign.simulator is not None, problem.distributions
    noise = noise or Noise.stated(problem.realisations)
    own_rule = optional.own_rule(problem.system)
    return Sample(shape, *counts, drawn.outside, confidence, noise, simulator, seed, drawn.redrawn, own_rule)


def certifying(seed: SampleSeed) -> str:
    """Which seed the sample of a certify stage has, in words."""
    return sentences.STATED_SEED if seed.stated else ""


def of_search(context: Context, method: Method, options: Any, columns: Columns) -> Statement:
    """The statement of a random search: a bound only if its points are independent; with early stopping, one that
    allows for the interim analyses."""
    confidence = context.campaign.confidence
    kind = Noise.of_calls(context, single=False)
    sample = Sample.of(columns, context.problem, confidence, kind, sentences.CAMPAIGN_SEED)
    drawn = method.sampling(options, len(columns.status), confidence)
    if drawn.barred:
        return sample.unclaimed(drawn.points, drawn.barred)
    statement = sample.statement(drawn.level)
    if drawn.level is None:
        return statement
    interim = sentences.interim(statement.statement, drawn.looks, drawn.level)
    return statement.model_copy(update={"looks": drawn.looks, "statement": interim})
