"""Which searches came to a finding by themselves, and how the findings were gathered, by what is stored."""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.asked.allowance import validation
from campaigns.claims.say import say
from campaigns.claims.spans import Quantity, Spans
from campaigns.claims.stages import ends
from campaigns.results.base import OK
from campaigns.results.draws import of_draws
from campaigns.results.finding import FoundBy, Validation
from worker.evidence.audit import limits
from worker.evidence.audit.parts import OMIT, changed, made
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.sentences import SPANS, alike, budget


def found_by(run: Run, position: int) -> list[FoundBy]:
    """The searches that came close to a finding, or had a result of their own in its basin, with the evaluations that
    they needed; of one that is a stored evaluation as it was, which has no slices, the search that made it."""
    finding = run.claims["findings"][position]
    stated = [_stated(run, one["position"], one.get("evaluations", OMIT)) for one in finding["found"]]
    if run.reworded:
        return stated
    worst, point = float(finding["cost"]), np.array(finding["point"])
    near = limits.SAME_COST * _scale(run, worst)
    exact = (run.status == OK) & (run.raw == worst) & (run.points == point).all(axis=1)
    if not _alone(run, position):
        exact &= run.stage < len(run.plan) - 1
    every: list[FoundBy] = []
    own: list[list[FoundBy]] = [[]] if exact.any() and not np.isin(run.stage[exact], run.searches).any() else []
    for k in run.searches:
        points, raw, status = run.rows(k)
        low = (status == OK) & (raw <= worst + near)
        close = (np.abs(points - point) <= limits.SAME_PLACE).all(axis=1)
        close[_own(run, k, finding["label"])] = True
        close &= low
        if close.any():
            every.append(_entry(run, k, close))
        here = exact[run.stage == k]
        own += [[_entry(run, k, here)]] if here.any() else []
    return stated if not finding.get("slices") and stated in own else every


def _own(run: Run, k: int, label: str) -> list[int]:
    """The rows of a search's best, of its parts and of its minima that are in the basin of a finding, as taken."""
    result, row = run.claims["results"][k], run.claims["comparison"][run.searches.index(k)]
    points, raw, status = run.rows(k)
    rows = [int(np.argmin(np.where(status == OK, raw, np.inf)))] if row["basin"] == label else []
    parts = zip(result.get("apart") or (), row.get("apart") or (), strict=True)
    rows += [part["index"] for part, basin in parts if basin == label]
    for minimum, basin in zip(result["minima"], row.get("minima") or (), strict=True):
        here = (points == np.array(minimum["point"])).all(axis=1)
        rows += np.flatnonzero(here)[:1].tolist() if basin == label else []
    return rows


def noise(run: Run, position: int, case: Validation) -> Validation:
    """The case of a finding with the noise seed if it is a stored evaluation with its own noise, from the sample's seed
    and its index, or that of the case of the baseline; none for one whose evaluation has the noise of the campaign."""
    if run.wording < limits.BASELINES or run.calls.noisy or not run.random:
        return case
    finding = run.claims["findings"][position]
    worst, point = float(finding["cost"]), np.array(finding["point"])
    seeds: list[int | None] = []
    for k in range(len(run.plan)):
        points, raw, status = run.rows(k)
        own = _seeds(run, k)
        same = (status == OK) & (raw == worst) & (points == point).all(axis=1)
        seeds += [own[row] if row < len(own) else None for row in np.flatnonzero(same).tolist()]
    stated = finding["validation"]["realisation"]
    return changed(case, realisation=stated if stated in seeds else next(iter(seeds), None))


def _seeds(run: Run, k: int) -> list[int]:
    """Those of a stage's first evaluations, each of which has its own."""
    result = (run.claims.get("results") or [])[k] or {}
    if result.get("realisations") is not None:
        return [*result["realisations"]]
    own = [
        (case["index"], case["realisation"])
        for case in result.get("cases") or ()
        if case.get("realisation") is not None
    ]
    if own:
        return [seed for _, seed in sorted(own)]
    drawn = result.get("drawn_realisations") or 0
    return of_draws(int(result["seed"]), 0, drawn).tolist() if drawn else []


def gathered(run: Run) -> Spans:
    """The sentence on how findings were gathered, with the number of descents or cases that it states, as taken."""
    stated = run.claims["results"][-1]["findings"]
    whole = [say(ends.FINDINGS), say(ends.NOTHING)]
    numbers = {
        span.name: int(span.value) for span in SPANS.validate_python(stated["statement"]) if isinstance(span, Quantity)
    }
    total, kept = validation(run.campaign, run.calls.noisy).total, min(numbers.get("kept", 0), len(run.findings))
    lost = [ends.confirmed(kept, total), ends.skipped(numbers.get("points", 0), total)]
    partly = [*lost, *map(ends.by_validation, (budget(numbers.get("budget", 0)), *whole))]
    possible = [ends.gathered(ended, stated["complete"]) for ended in (whole if stated["complete"] else partly)]
    return next((one for one in possible if alike(stated["statement"], one)), possible[0])


def _alone(run: Run, position: int) -> bool:
    """Whether an evaluation of the validation itself can be listed as it was: with its own noise, or since no descent
    ended in a confirmed violation."""
    if (run.claims["findings"][position].get("validation") or {}).get("realisation") is not None:
        return True
    pairs = zip(run.claims["findings"], run.findings, strict=True)
    return not any(stated.get("slices") and found.validation.violates for stated, found in pairs)


def _entry(run: Run, k: int, rows: Any) -> FoundBy:
    return _stated(run, k, int(np.argmax(rows)) + 1)


def _stated(run: Run, k: int, evaluations: int) -> FoundBy:
    method: Any = run.plan[k].method
    return made(FoundBy, position=k, method=method, evaluations=evaluations)


def _scale(run: Run, worst: float) -> float:
    """Nominal less worst, or what all others span where that is far above them; the size of the worst if the nominal
    case is not above it."""
    fall = run.nominal - worst
    if not fall > 0.0:
        return max(abs(worst), 1e-12)
    known = ((k, *run.rows(k)[1:]) for k in range(len(run.plan) - 1))
    # Not those of a noise realisation of their own.
    rows = [(raw[len(_seeds(run, k)) :], status[len(_seeds(run, k)) :]) for k, raw, status in known]
    costs = np.concatenate([raw[status == OK] for raw, status in rows])
    while run.wording >= limits.EACH and (below := far_above(costs, worst, fall)):
        fall = below
    return fall


def far_above(costs: Any, worst: float, fall: float) -> float:
    """How far above the worst the highest of a hundred costs or more is, all of which are in the lowest tenth of a
    fall, but those near its top; 0 if others are in between."""
    low = np.sort(costs[costs < worst + limits.TOP * fall])
    height = float(low[-1]) - worst if len(low) >= limits.MANY else 0.0
    return height if 0.0 < height < limits.BOTTOM * fall else 0.0
