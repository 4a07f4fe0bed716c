"""Baseline: the findings of an earlier run on this model, one evaluation each.

A finding is evaluated at all values that it has there, those that its campaign fixed included, on the same obstacles
and faults, wherever they are listed (`campaigns.checked.lists`). One whose parameters
this campaign cannot have, or that an evaluation of it would not show, is named with the reason and not evaluated. One
that drew its own noise is evaluated with the same seed. The evaluations are stored as all others, so that the minimum
counts them, and validation descends from each of them (`worker.engine.stages.parts.findings`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from campaigns import Campaign
from campaigns.asked.lists import prefix_of
from campaigns.asked.regression import Baseline, BaselineCase
from campaigns.asked.scenario import Repeats
from campaigns.checked.check import unvaried
from campaigns.checked.lists import Listed, matched, renamed, renumbered, reseeded
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
    then, now = Listed.of_baseline(baseline), _listed(problem)
    parts = matched(then, now)
    here = _renamed(baseline, parts)
    other_noise = [earlier_run.renumbered(p, baseline.run) for p in renumbered(then, now, parts)]
    other_noise += [earlier_run.other_seed(*row) for row in reseeded(then, now, parts)]
    both = list(zip(baseline.cases, here.cases, strict=True))
    reasons = {there.label: _unusable(problem, here, there, case, parts, other_noise) for there, case in both}
    usable = [case for case in here.cases if not reasons[case.label]]
    usable.sort(key=lambda case: case.realisation is None)
    points = [_point(problem, here, case) for case in usable]
    seeds = [case.realisation for case in usable if case.realisation is not None]
    columns = drive(context, position, _asking(points, seeds), len(points) + 1).columns
    index = {case.label: row for row, case in enumerate(usable)}
    cases = [_case(problem, *row, reasons[row[0].label], index.get(row[0].label), columns) for row in both]
    stated = [earlier_run.Case(c.label, c.index is not None, c.cost is not None, c.reason, c.assumed) for c in cases]
    moved = {p: q for case in baseline.cases if case.label in index for p, q in _moved(case, parts).items()}
    thresholds = (baseline.threshold, problem.threshold)
    statement = earlier_run.evaluated(baseline.run, stated, thresholds, problem.unit, moved)
    return Outcome(BaselineResult(run=baseline.run, cases=cases, drawn_realisations=len(seeds), statement=statement))


def _asking(points: list[Floats], seeds: list[int]) -> Asking[str]:
    if seeds:
        yield Seeded(np.array(points[: len(seeds)]), np.array(seeds, dtype=np.int64))
    if len(points) > len(seeds):
        yield np.array(points[len(seeds) :])
    return ends.BASELINE


def _listed(problem: Problem) -> Listed:
    return Listed.of(problem.campaign, {p.path: p.nominal for p in problem.system.parameters})


def _renamed(baseline: Baseline, parts: Mapping[str, str]) -> Baseline:
    """The baseline with the paths of this campaign, without the values of listed parts that it does not have."""

    def values(there: Mapping[str, float]) -> dict[str, float]:
        paths = {path: renamed(path, parts) for path in there}
        return {here: there[path] for path, here in paths.items() if here is not None}

    cases = [case.model_copy(update={"parameters": values(case.parameters)}) for case in baseline.cases]
    return baseline.model_copy(update={"cases": cases, "fixed": values(baseline.fixed or {})})


def _moved(there: BaselineCase, parts: Mapping[str, str]) -> dict[str, str]:
    """The listed parts of which a finding has values, and which are at another index here."""
    prefixes = dict.fromkeys(map(prefix_of, there.parameters))
    return {prefix: parts[prefix] for prefix in prefixes if parts.get(prefix, prefix) != prefix}


def _unusable(
    problem: Problem, here: Baseline, there: BaselineCase, case: BaselineCase, parts: Mapping[str, str],
    other_noise: list[str],
) -> str:  # fmt: skip
    """Why this campaign cannot evaluate a finding, as clauses; empty if it can. there: the finding as the baseline has
    it; case: with the paths of this campaign."""
    known = here.parts or {}
    unknown = [prefix for prefix in dict.fromkeys(map(prefix_of, there.parameters)) if prefix and prefix not in parts]
    found = [earlier_run.unidentified(prefix, here.run, known.get(prefix, "")) for prefix in unknown]
    found += [*_impossible(problem, here, case), *(other_noise if problem.realisations.random else [])]
    moved = [earlier_run.other_index(p, here.run, q) for p, q in _moved(there, parts).items()]
    return "; ".join([*moved, *found] if found else [])


def _impossible(problem: Problem, here: Baseline, case: BaselineCase) -> Iterator[str]:
    """What of a finding this campaign cannot have, or would not show."""
    ranges = {r.path: r for r in problem.ranges}
    for path, value in case.parameters.items():
        known = ranges.get(path)
        if path not in problem.paths:
            yield earlier_run.no_parameter(path)
        elif known is None:
            fixed = float(problem.system.nominal[problem.paths[path]])
            if fixed != value:
                yield earlier_run.certain(path, value, fixed)
        elif not _within(known, value):
            yield earlier_run.outside(path, value, known.low, known.high)
    yield from _elsewhere(problem, here, case)
    random = bool(problem.realisations.random)
    if case.realisation is not None and not random:
        yield earlier_run.not_random(case.realisation)
    yield from _unseen(problem.campaign, case, random)


def _elsewhere(problem: Problem, baseline: Baseline, case: BaselineCase) -> Iterator[str]:
    """What the baseline did not vary, and this campaign cannot have as it was there: values of what it varies, which
    must be known and within its bounds, and seeds that select another realisation."""
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


def _point(problem: Problem, here: Baseline, case: BaselineCase) -> Floats:
    """The finding as a point (n,): its own one if this campaign has the same bounds, so that the bits are the same."""
    own = np.array(case.point)
    if len(own) == problem.dimension and problem.named(own) == case.parameters:
        return own
    return np.clip(problem.point({**(here.fixed or {}), **case.parameters}), 0.0, 1.0)


def _case(
    problem: Problem, there: BaselineCase, case: BaselineCase, reason: str, row: int | None, columns: Columns | None
) -> Reevaluated:
    if row is None or columns is None:
        return Reevaluated(label=case.label, index=None, parameters=there.parameters, reason=reason)
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
