"""The result of the validate stage for the run; the evidence for each finding is stored in the finding."""

from __future__ import annotations

from typing import Annotated, Literal

from campaigns.documented import UNLESS_EMPTY, UNLESS_NONE
from campaigns.results.base import Described, MethodKind, Result, Status, Stop, Untraced, Values
from campaigns.results.estimate import NamedModes
from campaigns.results.finding import ClosestApproach, Validation
from campaigns.results.stage import StageResult


class Gathered(Described):
    """How the findings were distinguished."""

    distance: float
    """Fraction of every range."""
    barrier: float
    """Fraction of nominal minus worst."""
    at_most: int
    candidates: int
    left_out: int
    """Local minima no worse than the nominal case."""
    rounds: int = 0
    complete: bool


class LeftOut(Result):
    """What was not confirmed because the allowance of validation was used up."""

    findings: int = 0
    violations: int = 0
    calls: int = 0
    """Violations of a simulator that does not repeat that were not called as often as a finding."""
    spot_checks: int = 0
    cases: int = 0
    """Of the baseline: violations there that are none here."""


class Spent(Result):
    """The evaluations of validation."""

    at_most: int
    """Its allowance, evaluations made again to confirm results included."""
    stored: int
    """Those that distinguish the worst cases."""
    left_out: LeftOut


class Compared(Result):
    """A search next to the others, once all findings are known."""

    position: int
    method: str
    title: str
    kind: MethodKind
    best: float | None
    evaluations: int
    failed: int
    excluded: int = 0
    seconds: float
    to_near_best: int | None
    """Evaluations until within 1 % of nominal minus worst of the best known; null if it never got there."""
    basin: str | None = None
    """The finding whose basin contains its best; null if there is none."""
    findings: list[str]
    """Labels of the findings that it found by itself."""
    stop: Stop | None
    apart: Annotated[list[str | None], UNLESS_EMPTY] = []
    """The finding whose basin contains the best of each of its parts that were apart, in their order; null if there is
    none; omitted if it has only one part."""
    minima: Annotated[list[str | None], UNLESS_EMPTY] = []
    """The finding whose basin contains each of its minima, in their order; null if there is none; omitted if it has no
    minima, and in results of earlier versions."""


class StageCount(Result):
    """Evaluations of one stage."""

    position: int
    count: int


class Violations(Described):
    """Violating evaluations of all stages, and how many of those that were simulated again violate there too."""

    stored: int
    by_stage: list[StageCount] = []
    checked: int
    confirmed: int


class Furthest(Result):
    """The evaluation at which the two integrators differ most."""

    position: int
    index: int
    cost: float
    reference: float
    parameters: Values
    realisation: int | None = None


class SpotChecks(Described):
    """Random evaluations of all stages with the reference integrator."""

    checked: int
    compared: int
    largest: float | None
    """Difference from the stored value, in the criterion's unit."""
    median: float | None
    violating: int
    """Violate only with the reference integrator."""
    lowest_reference: Annotated[float | None, UNLESS_NONE] = None
    """The lowest value by it; omitted if none was compared, and in results of earlier versions."""
    at: Furthest | None
    reasons: list[str] = []
    """Why some could not be compared."""


class Unseen(Result):
    """The nominal case with an avoider that sees no obstacle."""

    cost: float | None
    status: Status
    reason: str
    deviation: float | None
    """The largest distance between the two paths at one instant [m]."""


class Spread(Result):
    """Lowest and highest cost of all stored evaluations."""

    evaluations: int
    lowest: float | None
    highest: float | None
    one_point: Annotated[bool, UNLESS_EMPTY] = False
    """Whether all that have a cost are of one point, so that no effect of a parameter can be seen; omitted if they are
    not, and in results of earlier versions."""
    grid: Annotated[float, UNLESS_EMPTY] = 0.0
    """The coarsest step of which all differences of these costs, or of the lowest, are multiples, as of values that a
    simulator rounds; the difference of the two lowest where the lowest return often and have no such step; omitted if
    there is none, and in results of earlier versions."""


class Later(Result):
    """The closest approach of a flight after the horizon."""

    name: str
    """nominal, a finding, or an evaluation of the sample."""
    value: float
    """The criterion's value there; at least that if it is extrapolated."""
    time: float
    """After the horizon [s]."""
    obstacle: int
    distance: float
    """To the centre of that obstacle at the last sample [m]."""
    closing: float
    """The speed at which that distance falls at the last sample [m/s]; negative while it grows."""
    simulated: bool
    """Simulated on beyond the horizon; else extrapolated."""
    until: Annotated[float | None, UNLESS_NONE] = None
    """The last instant of its simulation, which fails then [s]; omitted if it does not fail, and in results of earlier
    versions."""
    vehicle: Annotated[bool | None, UNLESS_NONE] = None
    """Of one that is not known: whether that is because the vehicle would come so close only if it went straight on
    for longer than it is followed; else omitted, as in results of earlier versions."""
    goal: Annotated[float | None, UNLESS_NONE] = None
    """Of one that is not known because the vehicle comes to its goal only after it is simulated: how long after [s]."""


class Beyond(Result):
    """What flights meet beyond the horizon."""

    times: float
    """They are simulated on to this multiple of the horizon, or until they fail, and extrapolated from there."""
    flights: int
    """The nominal case, the findings, the sample and others, under each of their noise realisations."""
    not_continued: Annotated[int | None, UNLESS_NONE] = None
    """How many evaluations with a value are not simulated on; omitted in results of earlier versions, which simulated
    only the nominal case, the findings and the sample on."""
    cut_short: Annotated[int | None, UNLESS_NONE] = None
    """How many of them fail after the horizon, and before that multiple; they are extrapolated from their last step.
    Omitted in results of earlier versions, which may not have counted what was simulated before the failure."""
    closer: int
    """How many of them come closer there than any evaluation of the run."""
    lowest: Later | None
    """The one that comes closest; null if none meets an obstacle there. Where none comes closer than an evaluation, its
    value is the least at the samples of a line."""
    unknown: Annotated[Later | None, UNLESS_NONE] = None
    """The closest one to an obstacle that may come closer: it has states, or neither repeats its path nor ends it, and
    is neither at rest nor moves away at a constant velocity; or to one by which the criterion would come to the
    threshold if the vehicle went straight on for longer than it is followed. Its value is that on straight lines."""

    @property
    def least(self) -> Later | None:
        """The one that comes closest, unless another one that is not known may come closer still."""
        lower = self.lowest is not None and self.unknown is not None and self.unknown.value < self.lowest.value
        return None if lower else self.lowest


class Mismeasured(Result):
    """A place at which the criterion does not compute the distance that its component declares (`measured_to`)."""

    obstacle: int
    """The one about which it is, from 0."""
    time: float
    """Of the simulation [s]."""
    position: list[float]
    """Of the vehicle [m]."""
    distance: float
    """That to the nearest obstacle's centre, or to its surface less the radius of the vehicle's body [m]."""
    value: float | None
    """The criterion's value there, in its own unit; null if it has none."""
    overstated: Annotated[Literal[True] | None, UNLESS_NONE] = None
    """True if the obstacle's own gap is larger than the distance, which is at most what is stated: a place nearby has a
    gap that is smaller by more than the two are apart."""


class Encounter(Result):
    """Evidence that the avoidance was tested."""

    closest: ClosestApproach
    """Of the nominal case; that of a finding is in the finding."""
    moved: float | None
    """Length of the nominal path [m]."""
    unseen: Unseen | None
    """Null for a system that cannot determine it."""
    spread: Spread
    influence: Values
    """By path: the largest change along any slice; without a parameter that has no slice with several values."""
    no_value: Annotated[dict[str, list[Status]], UNLESS_EMPTY] = {}
    """By path: how the evaluations of its slices ended that have no value; without a parameter that has none such, and
    omitted in results of earlier versions."""
    beyond: Annotated[Beyond | None, UNLESS_NONE] = None
    """Omitted for a system that is not simulated on, for a criterion that is not one of obstacles, and in results of
    earlier versions."""
    begins: Annotated[dict[str, tuple[float, float]], UNLESS_EMPTY] = {}
    """By path, of faults and the environment: the earliest and the latest instant at which it first changes, by the
    switches that it declares [s], of those for which the latest is after the horizon, or both are at its end."""
    whole: Annotated[dict[str, tuple[float, float]], UNLESS_EMPTY] = {}
    """By path, of faults and the environment that build up: the earliest and the latest instant at which the effect is
    whole [s], of those for which the latest is after the horizon. Omitted in results of earlier versions."""
    idle: Annotated[dict[str, int], UNLESS_EMPTY] = {}
    """By path, of faults and the environment that change no flight: of so many that were compared, spread over the
    bounds. Omitted in results of earlier versions, which compared none."""
    mismeasured: Annotated[Mismeasured | None, UNLESS_NONE] = None
    """Omitted for a criterion that computes the distance that it declares, or declares none, and in results of earlier
    versions, which did not compare them."""


class Incumbent(Result):
    """The best evaluation of a search by a simulator that does not repeat, and what independent calls of it show."""

    position: int
    method: str
    title: str
    cost: float
    """As the search stored it."""
    parameters: Values
    validation: Validation


class Downhill(Result):
    """A stored violation with no barrier on the line to it."""

    position: int
    """Of its stage."""
    index: int
    cost: float


class Line(Result):
    """The straight line from a violation of the baseline to the finding of its basin, which are one only if no case on
    it is clear."""

    end: list[float]
    """On the unit cube: the finding, or a point so close to it that both are at one place."""
    highest: float | None
    """The highest cost of the cases between both ends; null if one of these has no cost."""


class CaseBasin(Result):
    """What is known of the basin of a case of the baseline."""

    lowest: float | None
    """The lowest cost in the basin in which a descent from it ended, a finding or not; null if none has ended."""
    parameters: Annotated[Values | None, UNLESS_NONE] = None
    """At that cost; omitted if a finding has them."""
    violation: Annotated[Downhill | None, UNLESS_NONE] = None
    """Of a case that violates no more; omitted if there is none."""
    line: Annotated[Line | None, UNLESS_NONE] = None
    """Omitted if it decides nothing: the case did not violate or the finding does not, or both are at one place; and in
    results of earlier versions."""
    confirmed: Annotated[Validation | None, UNLESS_NONE] = None
    """The case simulated again by other means, of one that violated and does not here; omitted of any other, if the
    allowance did not suffice, and in results of earlier versions."""
    not_compared: int = 0
    """Stored violations that the line was not evaluated to, because the allowance was used up; those close to each
    other count once."""


class ValidateResult(StageResult, Described):
    """The validation of the run. The findings contain their own evidence."""

    stage: Literal["validate"] = "validate"
    ok: bool
    tolerance: float
    nominal: Validation | None
    """Null in results of earlier versions."""
    findings: Gathered | None = None
    comparison: list[Compared] = []
    violations: Violations | None = None
    spot_checks: SpotChecks | None = None
    encounter: Encounter | None = None
    incumbents: Annotated[list[Incumbent], UNLESS_EMPTY] = []
    """The best of every search, called again if the simulator does not repeat; omitted otherwise."""
    untraced: Untraced = {}
    spent: Annotated[Spent | None, UNLESS_NONE] = None
    """Omitted in results of earlier versions."""
    since: Annotated[list[str | None], UNLESS_EMPTY] = []
    """The finding whose basin contains each case of the baseline, in their order; null if there is none; omitted
    without a baseline."""
    basins: Annotated[list[CaseBasin], UNLESS_EMPTY] = []
    """What is known of the basin of each case of the baseline, in their order; omitted without one, and in results of
    earlier versions."""
    modes: Annotated[NamedModes | None, UNLESS_NONE] = None
    """Which findings the modes of an estimate of P(violation) are; omitted without one, and in results of earlier
    versions."""

    @property
    def halved(self) -> bool:
        return self.nominal is not None and self.nominal.half_step is not None

    @property
    def passing(self) -> list[Validation]:
        """Of the violations of the baseline that are none here: those that were simulated again by other means."""
        return [basin.confirmed for basin in self.basins if basin.confirmed is not None]

    @property
    def made_again(self) -> list[float]:
        cases = [self.nominal, *(best.validation for best in self.incumbents), *self.passing]
        spot = None if self.spot_checks is None else self.spot_checks.lowest_reference
        return [*(v for case in cases if case is not None for v in case.values), *([] if spot is None else [spot])]

    @property
    def unconfirmed(self) -> bool:
        spot = self.spot_checks
        return not self.ok or (spot is not None and (spot.violating > 0 or spot.compared < spot.checked))

    @property
    def later(self) -> list[tuple[str, float | None]]:
        beyond = None if self.encounter is None else self.encounter.beyond
        if beyond is None:
            return []
        closer = [beyond.lowest] if beyond.lowest is not None and beyond.closer else []
        unknown = [beyond.unknown] if beyond.unknown is not None else []
        return [*((each.name, each.value) for each in closer), *((each.name, None) for each in unknown)]
