"""Sentences on a random sample: its counts, the bound on P(violation), a bound on a quantile, a full grid."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from campaigns.claims.say import (
    amount,
    at_most,
    count,
    goal,
    listed,
    lowest,
    number,
    percent,
    probability,
    say,
    sure,
    symbol,
)
from campaigns.claims.spans import Spans, words


@dataclass(frozen=True)
class Terms:
    """The noise of the evaluations, in words: after the samples; as what the statement holds for."""

    drawn: str = ""
    holds: str = ""


STATED_SEED = " with a stated seed"
CAMPAIGN_SEED = " with the seed of the campaign"
"""After the samples, where the seed was not drawn at the launch, so that it may have been chosen."""

WITHOUT = Terms()
DRAWN = Terms(", each with its own noise realisation,")
CALLED = Terms(
    ", each by one call of the simulator,", ", over parameters and noise, if the noise of calls is independent"
)


def stated(combine: str, seeds: Sequence[int]) -> Terms:
    """The terms for evaluations that all simulate the realisations of the campaign."""
    named = words(listed([str(seed) for seed in seeds]))
    which = f"the {combine} of seeds {named}" if len(seeds) > 1 else f"seed {named}"
    return Terms(holds=f", for the stated noise only ({which})")


def combined(combine: str, calls: int) -> Terms:
    """The terms for evaluations by several calls of a simulator."""
    return Terms(holds=f", where each evaluation is the {combine} of {calls} calls")


@dataclass(frozen=True)
class Counts:
    """The numbers that the sentences on a sample state."""

    violations: int
    samples: int
    failed: int
    excluded: int
    outside: float
    confidence: float
    terms: Terms
    simulator: bool = False
    """Whether a simulator excluded draws, for reasons of its own."""
    seed: str = ""
    """Which seed the samples have, in words; empty if it was drawn at the launch."""
    own_rule: bool = False
    """Whether the criterion excluded draws by another rule than its threshold."""

    def bound(self, upper: float) -> Spans:
        """How many violate, and the bound on P(violation)."""
        drawn = f" drawn from the stated distributions{self.seed}{self.terms.drawn}"
        seen = say(count(self.violations, "violations"), " of ", amount(self.samples, "sample", "samples"), drawn)
        return say(
            *(
                seen,
                violate(self.failed, self.violations),
                f": P(violation){_over(self.excluded, self.outside)} is at most ",
            ),
            *(at_most(upper, name="upper_bound"), " with ", sure(self.confidence)),
            *(" confidence", self._beyond(), self._conditions(over_all=self.outside > 0.0)),
        )

    def unclaimed(self, points: str, why: str) -> Spans:
        """How many violate, and why no bound follows."""
        points = re.sub(r"\b(point|sample)s\b", r"\1", points, count=1) if self.samples == 1 else points
        estimate = say(" (an estimate of ", probability(self.violations / self.samples), ")") if self.samples else ()
        return say(
            *(count(self.violations, "violations"), " of ", count(self.samples, "samples"), f" {points}"),
            *(violate(self.failed, self.violations), estimate, f": {why}", self._conditions()),
        )

    def quantile(
        self, fraction: float, quantity: str, unit: str, order: int, needed: int | None, value: float | None
    ) -> Spans:
        """The bound on a quantile: the value of this order, or why there is none."""
        most, none = percent(fraction, 6, "share"), "no bound on the "
        if needed is None:
            return say(none, most, " quantile: ", probability(self.outside), " of the draws may be beyond the bounds")
        if order == 0:
            few = f" {'is' if self.samples == 1 else 'are'} too few for a bound on the "
            return say(
                amount(self.samples, "sample", "samples"), few, most, " quantile, which needs ", count(needed, "needed")
            )
        if value is None:
            return say(none, most, f" quantile: the {_ordinal(order)} lowest of the sample is a failed evaluation")
        counted = _over(self.excluded, self.outside) or (" that are not excluded" if self.excluded else "")
        return say(
            *("at most ", most, f" of all cases{counted} have ", symbol(quantity), " below "),
            *(lowest(value, unit, "bound"), ", with ", sure(self.confidence), " confidence"),
        )

    def _conditions(self, over_all: bool = False) -> Spans:
        """The conditions under which a statement holds: noise and exclusions; over_all: whether it counts all draws."""
        if not self.excluded:
            return say(self.terms.holds)
        draws = self.samples + self.excluded
        one = self.excluded == 1
        were = "was" if one else "were"
        start = "starts" if one else "start"
        only, why = "it holds only for starts above the threshold", f" {start} at or below it and {were} excluded"
        if self.simulator:
            only, why = "it holds only where the simulator excludes nothing", f" {were} excluded"
        if self.own_rule:
            only, why = "it holds only for starts that the criterion's own rule does not exclude", f" {were} excluded"
        if over_all:
            which = "that the simulator excludes" if self.simulator else "that start at or below the threshold"
            which = "that the criterion's own rule excludes" if self.own_rule else which
            only, why = f"draws {which} count as no violations", f" {were} excluded"
        return say(
            f"{self.terms.holds}; {only}: ",
            *(count(self.excluded, "draws_excluded"), " of ", count(draws, "draws"), " draws ("),
            *(probability(self.excluded / draws), f"){why}"),
        )

    def _beyond(self) -> Spans:
        if not self.outside:
            return ()
        most = at_most(self.outside, name="outside")
        return say(", of which at most ", most, " is the probability beyond the bounds")


def counted(draws: int, blocks: int, stored: int) -> Spans:
    """What is stored of a sample of which only a part is."""
    return say(
        *(count(stored, "stored"), " of ", amount(draws, "draw", "draws"), f" {'is' if stored == 1 else 'are'} stored"),
        ": the lowest, the first, and the first without a result; all are counted in ",
        *(amount(blocks, "block", "blocks"), ", which can be flown again from the seed of the sample"),
    )


class Drawn(NamedTuple):
    """What is known of a sample while it is drawn; outside: the probability beyond the bounds, None if not known;
    excluded: how many further draws were excluded; seed: as of `Counts`; failed: how many violations failed."""

    violations: int
    samples: int
    confidence: float
    outside: float | None
    excluded: int = 0
    seed: str = ""
    failed: int = 0


def violate(failed: int, violations: int) -> Spans:
    """The verb of so many violations, among which failed evaluations count: it states how many they are, if any."""
    verb = " violates the criterion" if violations == 1 else " violate the criterion"
    return say(verb, " or failed (", count(failed, "draws_failed"), " failed)") if failed else say(verb)


def interim(statement: Spans, looks: int, level: float) -> Spans:
    """The statement of a sample that may end early."""
    return say(
        statement,
        "; early stopping spends the error over interim analyses (alpha spending), so all their bounds hold together; "
        "this is interim analysis ",
        *(count(looks, "looks"), ", at ", sure(level, "level")),
    )


def curtailed(statement: Spans, allowed: int, target: float, samples: int, counted: int) -> Spans:
    """The statement of a sample that ended when too many violated; counted: the samples before its last block."""
    return say(
        statement,
        *("; it ended early, because at most ", count(allowed, "allowed"), " of ", count(samples, "requested")),
        *(" samples may violate for a bound of ", goal(target), ", and this bound counts the "),
        *(amount(counted, "sample", "bound_samples"), " before the last block"),
    )


def certified(drawing: Spans, quantile: Spans, samples: int, requested: int) -> Spans:
    """The sentence of a sample with its quantile, and how many samples are missing."""
    were = " was not excluded" if samples == 1 else " were not excluded"
    short = say("; only ", count(samples), " of ", amount(requested, "sample"), were)
    return say(drawing, "; ", quantile, short if samples < requested else ())


def so_far(counts: Drawn, upper: float, left: int, at_end: float) -> Spans:
    """A sample that is being drawn: its bound if it ended now, and its bound if none of those left violates."""
    where = " within the bounds" if counts.outside is None else _over(counts.excluded, counts.outside)
    beyond = say(
        ", of which at most ", at_most(counts.outside or 0.0, name="outside"), " is the probability beyond the bounds"
    )
    return say(
        *("so far ", count(counts.violations, "violations"), " of ", amount(counts.samples, "sample", "samples")),
        *(
            *(counts.seed, violate(counts.failed, counts.violations)),
            *(f": P(violation){where} is at most ", at_most(upper, name="upper_bound")),
        ),
        *(" with ", sure(counts.confidence), " confidence if it ended now, "),
        *(at_most(at_end, name="at_end"), " if none of the other ", count(left, "left"), " does"),
        beyond if counts.outside else (),
    )


def grid(points: int, total: int, lowest: tuple[str, float, str] | None, violations: int, failed: int) -> Spans:
    """A full grid; lowest: the criterion, its value and unit."""
    found = say("none of them could be evaluated")
    if lowest is not None:
        quantity, cost, unit = lowest
        found = say("lowest ", symbol(quantity), " ", number(cost, unit))
    return say(
        *("full grid of ", count(points), " points on every axis, ", count(total), " in all: ", found),
        *(", ", count(violations), violate(failed, violations)),
        "; nothing is claimed between these points",
    )


def _over(excluded: int, outside: float) -> str:
    """What a bound counts: how many of the draws beyond the bounds would be excluded is not known, so that it is not
    relative to those that are not."""
    return ", counted over all draws," if excluded and outside else ""


def _ordinal(r: int) -> str:
    ending = "th" if r % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(r % 10, "th")
    return f"{r}{ending}"
