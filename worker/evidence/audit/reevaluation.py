"""Recomputes what was evaluated of the findings of a baseline: each at all values that it has there, and only if an
evaluation of this campaign shows what one there did."""

from __future__ import annotations

import math
from typing import Any

from campaigns.asked.regression import BaselineCase
from campaigns.claims.stages import earlier_run
from campaigns.results.base import OK, STATUS
from campaigns.results.stage import Reevaluated
from campaigns.stages.baseline import BaselineResult
from worker.evidence.audit import limits, lists
from worker.evidence.audit.parts import OMIT, REST, changed, made
from worker.evidence.audit.recompute import Run

SLACK = 1e-9
"""The fraction of a range by which a value may be beyond its bounds, or differ by conversion of units."""


def position(run: Run) -> int:
    """Where the plan has the stage that evaluates the findings of the baseline."""
    return [planned.kind for planned in run.plan].index("baseline")


def evaluated(run: Run) -> BaselineResult:
    """The result of that stage, from the campaign's baseline and the evaluations."""
    baseline, stated = run.campaign.baseline, run.claims["results"][position(run)]["cases"]
    assert baseline is not None
    by_label = {recorded["label"]: recorded for recorded in stated}
    cases = [_evaluated(run, case, by_label.get(case.label, {}).get("index")) for case in baseline.cases]
    if run.wording < limits.BASELINES:
        older = [made(Reevaluated, label=case.label, cost=case.cost, **REST) for case in cases]
        return made(BaselineResult, cases=older, **REST)
    of = [
        earlier_run.Case(c.label, c.index is not None, c.status == STATUS[OK], r["reason"], r["assumed"])
        for c, r in zip(cases, stated, strict=True)
    ]
    known = lists.parts(run)
    seen = [case.parameters for case, again in zip(baseline.cases, cases, strict=True) if again.index is not None]
    moved = {
        part: q for values in seen if lists.complete(values, known) for part, q in lists.moved(values, known).items()
    }
    statement = earlier_run.evaluated(baseline.run, of, (baseline.threshold, run.threshold), run.unit, moved)
    return made(BaselineResult, run=baseline.run, cases=cases, statement=OMIT if run.reworded else statement)


def _evaluated(run: Run, case: BaselineCase, k: int | None) -> Reevaluated:
    """One finding of the baseline; the evaluation that its row names must be there, or its parameters impossible."""
    points, costs, status = run.rows(position(run))
    found = made(Reevaluated, label=case.label, realisation=None if k is None else case.realisation, **REST)
    if k is not None and run.wording >= limits.EACH and not (looked(run, case) and _stated(run, case)):
        return changed(found, index=None, cost=math.nan)
    if k is None:
        index = "an evaluation" if _possible(run, case) else None
        at = dict(case.parameters)
        return changed(found, parameters=at, point=[], status=None, cost=math.nan, index=index)
    ok, at = status[k] == OK, lists.here(case.parameters, lists.parts(run))
    return changed(
        found, index=k, parameters=run.values(points[k]), point=points[k].tolist(),
        status=dict(enumerate(STATUS)).get(int(status[k])), cost=float(costs[k]) if ok else math.nan,
        assumed=[path for path in run.bounds if path not in at], reason="" if ok else OMIT,
    )  # fmt: skip


def there(run: Run, case: BaselineCase, point: Any) -> bool:
    """Whether a point is at all values of a finding, those that the baseline did not vary included; before `EACH` these
    were nominal. What is beyond a bound by rounding is evaluated at the bound."""
    baseline, at, parts = run.campaign.baseline, run.values(point), lists.parts(run)
    here = {path: nominal for path, (_, nominal) in run.known.items()} | at
    slack = dict.fromkeys(here, 0.0) | dict(zip(at, SLACK * (run.high - run.low), strict=True))
    fixed = lists.here((baseline.fixed if baseline is not None and run.wording >= limits.EACH else None) or {}, parts)
    wanted = {path: fixed.get(path, run.known[path][1]) for path in at} | lists.here(case.parameters, parts)
    if not lists.complete(case.parameters, parts):
        return False
    return all(path in here and abs(here[path] - value) <= slack[path] for path, value in wanted.items())


def _possible(run: Run, case: BaselineCase) -> bool:
    """Whether this campaign can have the parameters of a finding of the baseline, and its noise."""

    def fits(path: str, value: float) -> bool:
        if path not in run.known:
            return False
        if path not in run.bounds:
            return float(run.known[path][1]) == value
        return _within(run, path, value)

    noise = case.realisation is None or bool(run.random)
    shown = noise and looked(run, case) and _stated(run, case)
    here = lists.here(case.parameters, lists.parts(run))
    return shown and all(fits(path, value) for path, value in here.items())


def _stated(run: Run, case: BaselineCase) -> bool:
    """Whether what the baseline did not vary is known, within the bounds where this campaign varies it, and the same
    where it selects a realisation; before `EACH` it was nominal. Since `PARTS` all parts of a case are here."""
    baseline = run.campaign.baseline
    if baseline is None or run.wording < limits.EACH:
        return True
    known = lists.parts(run)
    if not lists.complete(case.parameters, known) or not lists.numbered(run, known):
        return False
    own = lists.here(case.parameters, known)
    values = lists.here(baseline.fixed or {}, known) | own
    seeds = [path for path in run.fixed_seeds if path not in run.bounds and path not in own]
    alike = all(values.get(path) == run.known[path][1] for path in seeds)
    return alike and all(path in values and (path in own or _within(run, path, values[path])) for path in run.bounds)


def _within(run: Run, path: str, value: float) -> bool:
    """Whether this campaign can have a value of what it varies: bounds may have been computed in another way."""
    low, high = run.bounds[path]
    return low - SLACK * (high - low) <= value <= high + SLACK * (high - low)


def looked(run: Run, case: BaselineCase) -> bool:
    """Whether flights last until the closest approach of a finding, and have the noise with which it was found; whether
    an evaluation of a simulator is at least as many calls, of which no fewer count."""
    baseline, scenario = run.campaign.baseline, run.campaign.scenario
    if baseline is not None and run.campaign.simulator is not None and run.wording >= limits.EACH:
        then, here = baseline.repeats, run.campaign.simulator
        if then is None or here.calls < then.count:
            return False
        quantile = None if here.repeats is None else here.repeats.quantile
        return here.combine == "worst" or here.calls == 1 or (here.combine, quantile) == (then.combine, then.quantile)
    if baseline is None or scenario is None:
        return True
    needed = baseline.horizon if case.time is None else case.time
    long = baseline.horizon is None or scenario.horizon >= min(needed or 0.0, baseline.horizon)
    if not run.random or case.realisation is not None or baseline.realisations is None:
        return long
    before, now = baseline.realisations, scenario.realisations
    every = set(before.seeds) <= set(now.seeds) and now.combine == "worst"
    return long and (every or (before.combine == now.combine == "mean" and set(before.seeds) == set(now.seeds)))
