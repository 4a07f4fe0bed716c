"""Baseline: the findings of an earlier run on this model, one evaluation each.

A finding is evaluated at all values that it has there, those that its campaign fixed included. One whose parameters
this campaign cannot have, or that an evaluation of it would not show, is named with the reason and not evaluated. One
that drew its own noise is evaluated with the same seed. The evaluations are stored as all others, so that the minimum
counts them, and validation descends from each of them (`worker.engine.stages.parts.findings`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from campaigns import Campaign
from campaigns.asked.regression import Baseline, BaselineCase
from campaigns.asked.scenario import Repeats
from campaigns.checked.check import unvaried
from campaigns.claims.stages import earlier_run, ends
from campaigns.results.base import OK, STATUS
from campaigns.results.stage import Reevaluated
from campaigns.stages.baseline import BaselineResult
from campaigns.stored.records import Columns
from worker.engine.problem.distributions import Range
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Asking, Context, Seeded
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.systems.base import Floats

ROUNDING = 1e-9
"""Fraction of a range by which a value may be beyond a bound that was computed in another way."""


def run(context: Context, position: int) -> Outcome[BaselineResult]:
    """Evaluate every finding of the baseline that this campaign can evaluate, those with their own noise first."""
    problem, baseline = context.problem, context.campaign.baseline
    assert baseline is not None
    reasons = {case.label: _unusable(problem, case) for case in baseline.cases}
    usable = [case for case in baseline.cases if not reasons[case.label]]
    usable.sort(key=lambda case: case.realisation is None)
    points = [_point(problem, case) for case in usable]
    seeds = [case.realisation for case in usable if case.realisation is not None]
    columns = drive(context, position, _asking(points, seeds), len(points) + 1).columns
    index = {case.label: row for row, case in enumerate(usable)}
    cases = [_case(problem, case, reasons[case.label], index.get(case.label), columns) for case in baseline.cases]
    stated = [earlier_run.Case(c.label, c.index is not None, c.cost is not None, c.reason, c.assumed) for c in cases]
    thresholds = (baseline.threshold, problem.threshold)
    statement = earlier_run.evaluated(baseline.run, stated, thresholds, problem.unit)
    return Outcome(BaselineResult(run=baseline.run, cases=cases, drawn_realisations=len(seeds), statement=statement))


def _asking(points: list[Floats], seeds: list[int]) -> Asking[str]:
    if seeds:
        yield Seeded(np.array(points[: len(seeds)]), np.array(seeds, dtype=np.int64))
    if len(points) > len(seeds):
        yield np.array(points[len(seeds) :])
    return ends.BASELINE


def _unusable(problem: Problem, case: BaselineCase) -> str:
    """Why this campaign cannot evaluate a finding, as clauses; empty if it can."""
    ranges = {r.path: r for r in problem.ranges}
    found = []
    for path, value in case.parameters.items():
        known = ranges.get(path)
        if path not in problem.paths:
            found.append(earlier_run.no_parameter(path))
        elif known is None:
            fixed = float(problem.system.nominal[problem.paths[path]])
            if fixed != value:
                found.append(earlier_run.certain(path, value, fixed))
        elif not _within(known, value):
            found.append(earlier_run.outside(path, value, known.low, known.high))
    found += _elsewhere(problem, case)
    random = bool(problem.realisations.random)
    if case.realisation is not None and not random:
        found.append(earlier_run.not_random(case.realisation))
    return "; ".join([*found, *_unseen(problem.campaign, case, random)])


def _elsewhere(problem: Problem, case: BaselineCase) -> Iterator[str]:
    """What the baseline did not vary, and this campaign cannot have as it was there: values of what it varies, which
    must be known and within its bounds, and seeds that select another realisation."""
    baseline = problem.campaign.baseline
    assert baseline is not None
    ranges, fixed = {r.path: r for r in problem.ranges}, baseline.fixed or {}
    certain = {p.path: p.nominal for p in problem.system.parameters if p.path not in ranges}
    for path in [*ranges, *unvaried(problem.campaign, certain)]:
        value, known = fixed.get(path), ranges.get(path)
        if path in case.parameters:
            continue
        if value is None:
            yield earlier_run.unknown(path, baseline.run)
        elif known is None:
            here = float(problem.system.nominal[problem.paths[path]])
            if here != value:
                yield earlier_run.other_seed(path, value, here)
        elif not _within(known, value):
            yield earlier_run.outside(path, value, known.low, known.high)


def _within(known: Range, value: float) -> bool:
    """Whether a value is within bounds but for rounding; it is evaluated at the bound then."""
    slack = ROUNDING * (known.high - known.low)
    return known.low - slack <= value <= known.high + slack


def _unseen(campaign: Campaign, case: BaselineCase, random: bool) -> Iterator[str]:
    """What evaluations of this campaign do not show of a finding that those of the baseline did."""
    baseline, now = campaign.baseline, campaign.scenario
    if baseline is not None and campaign.simulator is not None:
        yield from _uncalled(baseline, campaign.simulator.repeats or Repeats(count=1))
    if baseline is None or now is None:
        return
    then, ended = baseline.realisations, baseline.horizon
    if ended is not None and now.horizon < ended and (case.time is None or case.time > now.horizon):
        yield earlier_run.shorter(now.horizon, case.time, ended)
    if random and case.realisation is None and then is not None and then.unseen(now.realisations):
        yield earlier_run.other_noise(then.unseen(now.realisations))


def _uncalled(baseline: Baseline, now: Repeats) -> Iterator[str]:
    then = baseline.repeats
    if then is None:
        yield earlier_run.unknown_calls(baseline.run)
    elif not then.shown_by(now):
        yield earlier_run.other_calls(then, now)


def _point(problem: Problem, case: BaselineCase) -> Floats:
    """The finding as a point (n,): its own one if this campaign has the same bounds, so that the bits are the same."""
    own = np.array(case.point)
    if len(own) == problem.dimension and problem.named(own) == case.parameters:
        return own
    baseline = problem.campaign.baseline
    fixed = {} if baseline is None else baseline.fixed or {}
    return np.clip(problem.point({**fixed, **case.parameters}), 0.0, 1.0)


def _case(problem: Problem, case: BaselineCase, reason: str, row: int | None, columns: Columns | None) -> Reevaluated:
    if row is None or columns is None:
        return Reevaluated(label=case.label, index=None, parameters=case.parameters, reason=reason)
    ok = columns.status[row] == OK
    return Reevaluated(
        label=case.label,
        index=row,
        parameters=problem.named(columns.points[row]),
        point=columns.points[row].tolist(),
        status=STATUS[int(columns.status[row])],
        cost=float(columns.costs[row, 0]) if ok else None,
        reason="" if ok else columns.reasons.get(row, ""),
        assumed=[r.path for r in problem.ranges if r.path not in case.parameters],
        realisation=case.realisation,
    )


stage = Stage("baseline", run)
