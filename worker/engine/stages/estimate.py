"""Estimate: P(violation) by importance sampling over the modes of the violations that the stages before found.

The random stream follows from the seed of the sample, which no user chose; every request follows from it and the
evaluations, so a stage that was stopped continues with the same points (`worker.engine.rare`).
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from campaigns.claims.stages import estimate as sentences
from campaigns.results.base import EXCLUDED, OK
from campaigns.results.estimate import (
    EstimateAlarm,
    ImportanceDensity,
    NoEstimate,
    NoEstimateWhy,
    Origin,
    Rows,
    ViolationMode,
)
from campaigns.stages.estimate import EstimateResult
from campaigns.stored.records import Columns
from worker.engine.problem.problem import Problem
from worker.engine.rare import starts
from worker.engine.rare.alarms import FEWEST, Alarm, Counts
from worker.engine.rare.alarms import NOTHING as NO_SAMPLE
from worker.engine.rare.estimate import Estimate, Mode, Refused, estimated, without_far
from worker.engine.rare.mixture import Mixture
from worker.engine.rare.starts import Stored
from worker.engine.search.base import Batch, Ended, Floats
from worker.engine.stages.parts import noise
from worker.engine.stages.parts.base import all_columns, drive, stream
from worker.engine.stages.parts.context import Context
from worker.engine.stages.parts.outcome import Outcome, Stage

STREAM = 2**25
"""Index of the random stream; searches use those from 0 on."""
ENDED = "drew {draws} weighted samples"
NOTHING = "estimated nothing"


def run(context: Context, position: int) -> Outcome[EstimateResult]:
    """Search for the modes, draw, and state what follows."""
    request, seed = context.campaign.stages.estimate, context.sample_seed
    assert request is not None
    known, first, origins = _violations(context, position, request.evaluations)
    made, outside = list[Estimate | Refused](), context.problem.distributions.outside
    searching = _search(context, known, first, request.evaluations, made)
    driven = drive(context, position, searching, request.evaluations + 1)
    empty = EstimateResult(
        confidence=context.campaign.confidence, outside=outside, seed=seed.value, drawn_at_launch=not seed.stated
    )
    uniform = context.problem.distributions.uniform(known.points[first])
    outcome = without_far(made[0] if made else Refused("no_violation"), starts.moved(uniform))
    if isinstance(outcome, Refused):
        return Outcome(_refused(context, outcome, request.evaluations, empty))
    assert driven.columns is not None
    modes = [_mode(context.problem, mode, origins) for mode in outcome.modes]
    return Outcome(_estimated(outcome, modes, driven.columns, request.evaluations, empty))


def _violations(context: Context, position: int, budget: int) -> tuple[Stored, NDArray[np.int64], list[Origin]]:
    """All violations and failed evaluations of the stages before, the rows of the starts among them, and where the
    starts and after them all others are stored; no row without a violation."""
    problem, points, costs = context.problem, [np.empty((0, context.problem.dimension))], [np.empty(0)]
    sampled, origins = [np.empty(0, dtype=bool)], list[Origin]()
    for at, columns in all_columns(context, list(range(position))):
        ok = columns.status == OK
        low = np.where(ok, np.nan_to_num(columns.costs[:, 0], nan=np.inf), np.inf)
        rows = np.flatnonzero((low <= problem.threshold) | (~ok & (columns.status != EXCLUDED)))
        points.append(columns.points[rows])
        costs.append(low[rows])
        sampled.append(np.full(len(rows), at in context.results and context.results[at].certificate is not None))
        origins += [Origin(position=at, index=int(row)) for row in rows]
    every = np.concatenate(points)
    normal = starts.normal(problem.distributions.uniform(every))
    known = Stored(every, np.concatenate(costs), normal, np.concatenate(sampled))
    first = starts.chosen(known, budget)
    return known, first, [origins[row] for row in (*first, *range(len(origins)))]


def _search(
    context: Context, known: Stored, first: NDArray[np.int64], budget: int, made: list[Estimate | Refused]
) -> Generator[Floats, Batch, str]:
    """The estimate, with its requests as points of the unit cube."""
    problem, random = context.problem, stream(context.sample_seed.value, STREAM)
    if noise.noisy(context) or not len(first):
        return NOTHING
    distributions, confidence = problem.distributions, context.campaign.confidence
    searching = estimated(
        known.normal[first],
        problem.threshold,
        budget,
        random,
        confidence,
        lambda u: ~distributions.beyond(_cube(problem, u)),
        known.normal,
        _certified(context),
    )
    try:
        normal_points = next(searching)
        while True:
            batch = yield _cube(problem, normal_points)
            normal_points = searching.send(batch)
    except StopIteration as stopped:
        outcome: Estimate | Refused = stopped.value
    made.append(outcome)
    return NOTHING if isinstance(outcome, Refused) else Ended("drawn", ENDED, draws=outcome.drawn)


def _certified(context: Context) -> Counts:
    """The counts of the run's independent sample, all that were drawn, whichever of them are stored."""
    distributions = context.problem.distributions
    for result in context.results.values():
        if result.certificate is not None:
            of = result.certificate.sample
            outside = _beyond(distributions.outside, of.samples, of.samples + of.excluded)
            # Its correlated draws beyond the bounds were drawn again within them.
            return Counts(of.violations, of.failed, of.samples, outside if distributions.unbounded else 0.0)
    return NO_SAMPLE


def _cube(problem: Problem, normal: Floats) -> Floats:
    """Points of standard normal space as points of the unit cube; correlated normal values beyond a bound are on it."""
    from scipy import special  # imported late: a campaign's process must start fast

    return problem.distributions.quantile(special.ndtr(normal), redrawn=False)


def _refused(context: Context, refused: Refused, budget: int, empty: EstimateResult) -> EstimateResult:
    n, noisy = context.problem.dimension, noise.noisy(context)
    why: NoEstimateWhy = "noise" if noisy else refused.why
    limit = 0 if noisy else refused.limit
    statement = {
        "no_violation": sentences.NO_VIOLATION,
        "too_far": sentences.TOO_FAR,
        "noise": sentences.NOISE,
        "budget": sentences.too_few(limit, n, budget),
        "parameters": sentences.too_many(limit, n),
    }[why]
    refusal = NoEstimate(why=why, limit=limit, statement=statement)
    return empty.model_copy(update={"refused": refusal, "statement": sentences.refused(statement)})


def _estimated(
    made: Estimate, modes: list[ViolationMode], columns: Columns, budget: int, empty: EstimateResult
) -> EstimateResult:
    """The numbers of an estimate with their sentences; no interval with an alarm."""
    found, (first, count) = made.interval, made.sampled
    size = int(np.count_nonzero(columns.status[first : first + count] != EXCLUDED))
    failed = bool(np.isin(columns.status, (OK, EXCLUDED), invert=True).any())
    alarms = [_alarm(alarm, found.probability, budget, failed) for alarm in made.alarms]
    beyond = _beyond(empty.outside, size, count)
    low, high = found.low * (1.0 - beyond), min(1.0, found.high + beyond)
    if alarms:
        statement = sentences.alarmed([alarm.statement for alarm in alarms])
    else:
        numbers = made.drawn, made.effective, made.failed, count - size, count, beyond
        draws = sentences.Draws(*numbers, not empty.drawn_at_launch)
        about = sentences.estimated(found.probability, (low, high), empty.confidence, draws)
        hidden = [mode.share for mode in modes if not mode.origins]
        shown = sentences.modes([m.share for m in modes], len(hidden), sum(hidden), failed)
        statement = sentences.whole(about, shown, failed)
    drawn = {
        "probability": found.probability,
        "low": None if alarms else low,
        "high": None if alarms else high,
        "variation": found.variation if np.isfinite(found.variation) else None,
        "effective": made.effective,
        "draws": made.drawn,
        "failed_draws": made.failed,
        "modes": modes,
        "alarms": alarms,
        "density": density(made.mixture),
        "independent": Rows(first=first, count=count),
        "final": Rows(first=len(columns.status) - made.drawn, count=made.drawn),
        "statement": statement,
    }
    return empty.model_copy(update=drawn)


def _beyond(outside: float, kept: int, drawn: int) -> float:
    """The probability beyond the bounds relative to what is not excluded: there, nothing may be excluded."""
    return min(1.0, outside * drawn / kept) if kept else 1.0


def density(mixture: Mixture) -> ImportanceDensity:
    """The mixture as it is stored."""
    names = ImportanceDensity.model_fields
    return ImportanceDensity.model_validate({name: getattr(mixture, name).tolist() for name in names})


def _mode(problem: Problem, mode: Mode, origins: list[Origin]) -> ViolationMode:
    return ViolationMode(
        share=mode.share,
        parameters=problem.named(_cube(problem, mode.design[None, :])[0]),
        distance=float(np.linalg.norm(mode.design)),
        origins=[origins[k] for k in mode.origins or ()],
    )


def _alarm(alarm: Alarm, probability: float, budget: int, failed: bool) -> EstimateAlarm:
    """An alarm with its sentence; failed: whether evaluations of the stage failed."""
    match alarm.why:
        case "sample":
            violations, lost, size, _ = alarm.counts
            statement = sentences.contradicted(violations, size, probability, lost > 0)
        case "weight":
            statement = sentences.single(alarm.value)
        case "few":
            statement = sentences.few(alarm.value, FEWEST)
        case "unexplained":
            statement = sentences.unexplained(int(alarm.value), budget, failed)
        case "unsaturated":
            statement = sentences.unsaturated(int(alarm.value))
    return EstimateAlarm(why=alarm.why, value=alarm.value, statement=statement)


stage = Stage("estimate", run)
