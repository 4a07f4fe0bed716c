"""The rules of a claim: every limit with its source, what each family of methods counts for, every check in its order.

Verdict, remedies, report, pages and guides read them; `worker.evidence.audit.limits` has the limits again on purpose.
The value of a limit that a run itself applies is in `campaigns.limits`, because it can change a number; nothing that
can do so imports this module. Start reading at `RULES`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

from campaigns import limits
from campaigns.codes import CheckCode

Number = TypeVar("Number", int, float)


@dataclass(frozen=True)
class Limit(Generic[Number]):
    """A number that a verdict depends on."""

    value: Number
    text: str
    """What it is."""
    source: str
    """Where it comes from: the campaign, a publication, a reason."""


USUAL = "usual value of the campaign"
CONVENTION = "convention"
EFFORT = "effort of a run"

AGREEMENT = Limit(limits.AGREEMENT, "agreement of methods, as a fraction of nominal minus worst", USUAL)
AGREEMENT_AT_MOST = Limit(0.2, "the same at most, whatever the campaign states", CONVENTION)
AGREEMENT_ROUNDING = Limit(
    limits.ROUNDING_AT_LEAST, "the same at least, as a fraction of nominal, worst case or threshold", "rounding"
)
AGREEMENT_OF_MARGIN = Limit(0.1, "the same at most, as a fraction of the margin of the worst case", CONVENTION)
METHODS = Limit(2, "families of methods that must reach the worst case", "no verdict rests on one principle of search")
GLOBAL_LEAST = Limit(25, "evaluations for each uncertain parameter that a global method needs", CONVENTION)
LOCAL_LEAST = Limit(3, "evaluations for each uncertain parameter that a local method needs", CONVENTION)
ROUNDING = Limit(limits.ROUNDING, "fraction below which a difference of what is compared is rounding", "rounding")
TOLERANCE = Limit(limits.TOLERANCE, "difference of evaluations of a case, as a fraction of its value", USUAL)
TOLERANCE_OF_MARGIN = Limit(limits.TOLERANCE_OF_MARGIN, "the same at most, as a fraction of the margin", CONVENTION)
DISTANCE = Limit(limits.DISTANCE, "fraction of every range within which two minima count as one", USUAL)
BARRIER = Limit(limits.BARRIER, "barrier between two minima that are distinct, of nominal minus worst", USUAL)
SAME_COST = Limit(limits.SAME_COST, "distance at which a worst case is found, of nominal minus worst", CONVENTION)
SAME_PLACE = Limit(limits.SAME_PLACE, "the same, as a fraction of every range", CONVENTION)
SPOT_CHECKS = Limit(limits.SPOT_CHECKS, "random evaluations that are simulated again", EFFORT)
VIOLATIONS = Limit(limits.VIOLATIONS, "stored violations that are simulated again, at most", EFFORT)
REPEATS = Limit(limits.REPEATS, "independent calls of a case of a simulator that does not repeat, at least", CONVENTION)
MOVED = Limit(0.01, "fraction of the nominal closest approach that the vehicle must at least move", CONVENTION)
ABOVE_NOISE = Limit(
    10.0,
    "standard deviations of a simulator's noise that the range of all evaluations must exceed",
    "the range of a million normal numbers",
)
EXCLUDED = Limit(0.1, "fraction of the draws, of a search, or of all evaluations, that may be excluded", CONVENTION)
SAMPLE = Limit(limits.SAMPLE, "random samples, independent of every search", "bounds P(violation) at 5 %, at 95 %")
REALISATIONS = Limit(limits.REALISATIONS, "whole numbers over which a seed must be uniform", CONVENTION)
TURN = Limit(limits.TURN, "angle by which an obstacle may turn within a step [rad]: pi/4", "aliasing")
CONTINUED = Limit(limits.CONTINUED, "multiple of the horizon to which flights are simulated on", CONVENTION)
OTHERS = Limit(limits.OTHERS, "evaluations besides the independent sample that are simulated on, at most", EFFORT)
DRAWS = Limit(limits.DRAWS, "draws for each requested sample, excluded ones included, at most", EFFORT)
CHANCE = Limit(1 / limits.CHANCE, "probability at most that calls of two runs differ so by chance", CONVENTION)
CEILING = Limit(0.05, "bound on P(violation) that a campaign without a target must meet", CONVENTION)
CONFIDENCE = Limit(limits.CONFIDENCE, "confidence of the bounds", USUAL)
CONFIDENCE_AT_LEAST = Limit(limits.CONFIDENCE_AT_LEAST, "the same at least, or a campaign is refused", CONVENTION)

LIMITS: Mapping[str, Limit[int] | Limit[float]] = {k: v for k, v in globals().items() if isinstance(v, Limit)}
"""All of them by name."""

CALLS = ((0.1, 5), (1 / 3, 10), (math.inf, 20))
"""Proposed calls for each evaluation of a simulator that does not repeat, where the standard deviation of its noise is
below this fraction of the nominal margin."""
CALLS_UNMEASURED = 10
"""The same where the noise or the margin is unknown."""


@dataclass(frozen=True)
class Family:
    """What the methods of a kind count for."""

    least: Limit[int] | None = None
    """Evaluations for each parameter below which one has not searched; None for a kind that cannot agree."""
    all_agree: bool = False
    """Whether every one of them must reach the worst case, not only count if it does."""
    converges: bool = False
    """Whether one that used up its budget has not searched."""
    samples: bool = False
    """Whether its points are an independent sample, which supports a claim on probability."""


FAMILIES: Mapping[str, Family] = {
    "global": Family(least=GLOBAL_LEAST, all_agree=True),
    "local": Family(least=LOCAL_LEAST, converges=True),
    "random": Family(samples=True),
    "multi": Family(),
}


class RemedyKind(StrEnum):
    """What a remedy changes."""

    STEP = "step"
    HORIZON = "horizon"
    EVALUATIONS = "evaluations"
    METHOD = "method"
    FINDINGS = "findings"
    SAMPLE = "sample"
    REALISATIONS = "realisations"
    CALLS = "calls"


@dataclass(frozen=True)
class Rule:
    """A check: what must hold before a campaign is cleared."""

    code: CheckCode
    title: str
    requires: str
    evidence: tuple[str, ...] = ()
    """The kinds of stages that it rests on; all of them if it is empty."""
    remedy: RemedyKind | None = None
    """What a next run changes first; None if the check needs a decision that no change of a number makes."""
    intended: str = ""
    """What the author of a campaign may state as intended instead; empty if nothing."""
    of_values: bool = False
    """Whether it holds only for the evaluations that have a value."""
    of_violations: bool = False
    """Whether violations alone can make it fail: where another one fails too, no policy accepts known ones."""


def percent(limit: Limit[float]) -> str:
    """The limit as percent."""
    return f"{100 * limit.value:g} %"


RULES = (
    Rule(CheckCode.NOMINAL, "Nominal case", "The nominal case meets the criterion.", ("nominal",), of_violations=True),
    Rule(
        CheckCode.SEARCH,
        "Searches ended",
        "Every search ended by its own rule or its budget, and evaluated a case successfully.",
        ("search",),
    ),
    Rule(
        CheckCode.NO_VIOLATION,
        "No violation",
        "No stored evaluation of any stage violates the criterion.",
        of_values=True,
        of_violations=True,
    ),
    Rule(
        CheckCode.MINIMUM,
        "Lowest evaluation",
        "The worst finding is the lowest of all evaluations, and it was fully polished.",
        remedy=RemedyKind.FINDINGS,
        of_values=True,
    ),
    Rule(
        CheckCode.AGREEMENT,
        "Agreement of methods",
        "At least one global method searched, every one reaches the worst case within the campaign's agreement, by "
        f"default {percent(AGREEMENT)} of nominal minus worst, and {percent(AGREEMENT_OF_MARGIN)} of the margin, "
        f"and methods of at least {METHODS.value} families do, which the campaign did not start there. Parts of a "
        "search that do not share their evaluations count as methods. Members that share evaluations or "
        "starting points count as one method, in all searches by the same method together, and no search by the "
        "principle of one of them confirms it.",
        ("search", "validate"),
        RemedyKind.EVALUATIONS,
    ),
    Rule(
        CheckCode.VALIDATION,
        "Integration",
        "The step-halving check and the reference integrator agree for the nominal case and every finding. Every "
        "random evaluation has a value with the reference integrator, and none violates the criterion with it alone.",
        ("validate",),
        RemedyKind.STEP,
    ),
    Rule(
        CheckCode.REPETITION,
        "Repeated evaluation",
        "Of a simulator, in place of the integrators: the nominal case and every finding agree when evaluated again, "
        "with a step also at half of it, or in independent calls. Every random evaluation has a value again, and none "
        "violates the criterion only then.",
        ("validate",),
        RemedyKind.CALLS,
    ),
    Rule(
        CheckCode.RESOLUTION,
        "Resolution of the values",
        "If the values, or the lowest of them, differ in steps, as those that a simulator rounds, the margin is not "
        "less than the step.",
    ),
    Rule(CheckCode.EVALUATIONS, "Failed evaluations", "No evaluation failed."),
    Rule(
        CheckCode.RETRIES,
        "Calls tried again",
        "Of a simulator with retries, or a vectorized function: no call that had failed succeeded when tried again.",
    ),
    Rule(
        CheckCode.CALLS,
        "Noise of the simulator",
        "Of a simulator: its results repeat, bit by bit and in every later comparison, or an evaluation is the worst "
        "of several calls and, in further independent calls of the nominal case, the findings and the best of every "
        f"search ({REPEATS.value} of each at least), none violates or fails.",
        ("nominal", "validate", "certify"),
        RemedyKind.CALLS,
        of_violations=True,
    ),
    Rule(
        CheckCode.CLOSEST_APPROACH,
        "Closest approach",
        "The closest approach of the nominal case and of every finding is inside the horizon, and neither they, nor "
        f"any stored flight of the independent sample, nor {OTHERS.value:,} other evaluations, spread over the bounds, "
        "come closer than any evaluation when simulated on to "
        f"{CONTINUED.value:g} times the horizon, or until they fail, and extrapolated from there. An obstacle whose "
        "further motion is not known, because it has states or neither repeats its path nor ends it, is then at rest "
        "or moves away at a constant velocity. If the vehicle goes straight on, or circles, for even longer, as far "
        "as it gets, it does not come to the threshold, nor to its goal, where it may turn, unless every obstacle "
        "moves away faster.",
        ("validate",),
        RemedyKind.HORIZON,
        "The closest approach may be at the start or at the end of the horizon, and flights may come closer beyond it "
        "than any evaluation, but none reaches the threshold there, and every further motion is known.",
    ),
    Rule(
        CheckCode.MOTION,
        "Vehicle motion",
        f"The vehicle moves more than {percent(MOVED)} of the nominal closest approach.",
        ("validate",),
        intended="The vehicle need not move.",
    ),
    Rule(
        CheckCode.AVOIDANCE,
        "Effect of the avoidance",
        "The avoidance makes a difference: the nominal case comes closer without it.",
        ("validate",),
        intended="The avoidance need not make a difference to the nominal case.",
    ),
    Rule(
        CheckCode.INFLUENCE,
        "Effect of the parameters",
        "The criterion varies over the evaluations, by more than the noise of a simulator, and every fault and part of "
        "the environment changes a flight.",
        intended="No uncertain parameter need change the criterion; a fault and a part of the environment must.",
    ),
    Rule(
        CheckCode.SAMPLING,
        "Motion of the obstacles",
        "No obstacle turns by more than pi/4 within a step, for any values within the bounds, at the rate that its "
        "component declares.",
        remedy=RemedyKind.STEP,
    ),
    Rule(
        CheckCode.DISTANCES,
        "Distances",
        "A criterion of obstacles states to which point of them it measures, and its value is that distance in m, or "
        "that it measures none. No distance to the centre of an obstacle hides a vehicle inside it, and every obstacle "
        "declares its extent, unless the campaign states that such a distance is meant.",
    ),
    Rule(
        CheckCode.NOISE,
        "Noise realisations",
        "With noise, an independent sample draws a realisation for every evaluation, none is a mean over several, and "
        f"every parameter that is a seed is uniform over at least {REALISATIONS.value} whole numbers, but those that "
        "realisations vary.",
        ("certify",),
        RemedyKind.REALISATIONS,
    ),
    Rule(
        CheckCode.EXCLUSIONS,
        "Excluded starts",
        f"At most {percent(EXCLUDED)} of the draws of the sample, of the evaluations of each search, and of all "
        "evaluations, were excluded.",
    ),
    Rule(
        CheckCode.SAMPLE,
        "Independent sample",
        f"An independent sample of at least {SAMPLE.value} was drawn from the distributions, with a seed that was "
        "drawn at launch, not chosen by a user.",
        ("certify",),
        RemedyKind.SAMPLE,
    ),
    Rule(
        CheckCode.OUTSIDE,
        "Draws outside the bounds",
        f"Of normal distributions, at most {percent(CEILING)} of all draws lie outside the bounds, where nothing is "
        "evaluated.",
    ),
    Rule(
        CheckCode.PROBABILITY,
        "Bound on P(violation)",
        f"If there is an independent sample and no target, its bound on P(violation) is at most {percent(CEILING)}.",
        ("search", "certify"),
        RemedyKind.SAMPLE,
        of_violations=True,
    ),
    Rule(
        CheckCode.TARGET,
        "Target for P(violation)",
        f"If the campaign states a target, the bound on P(violation) of an independent sample meets it; a target above "
        f"{percent(CEILING)} does not loosen what is required.",
        ("search", "certify"),
        RemedyKind.SAMPLE,
        of_violations=True,
    ),
)
"""Every check in the order in which a verdict states it."""

_BY_CODE = {str(rule.code): rule for rule in RULES}


def required(target: float | None) -> float:
    """The bound on P(violation) that a campaign must meet: its target, which can be stricter than the ceiling only."""
    return CEILING.value if target is None else min(target, CEILING.value)


def rule(code: str) -> Rule | None:
    """The rule of that check; None for one of an earlier version or of another package."""
    return _BY_CODE.get(code)


def position(code: str) -> int:
    """The position of a check among all; one without a rule comes last."""
    return RULES.index(_BY_CODE[code]) if code in _BY_CODE else len(RULES)
