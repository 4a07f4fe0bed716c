"""Recomputes the comparison with a baseline: margins, changes, tolerances, standings, and what follows from the policy.

Taken as given: which finding of this run is in the basin of one of the baseline, which of the evaluations is the lowest
there, and between which stored violations and a case no barrier was found. That no case is clear between a violation of
the baseline and the finding of this run that is the same is judged by the stored evaluations between them. The
values of a case that was confirmed by other means are taken as those of a finding are.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from campaigns.asked.regression import BaselineCase, FailOn
from campaigns.results.base import OK
from campaigns.results.finding import Validation
from campaigns.results.regression import FindingChange, Regression
from worker.evidence.audit import limits
from worker.evidence.audit.modes import NEAR
from worker.evidence.audit.parts import OMIT, REST, changed, made
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.reevaluation import position

LINE = 32
"""Equal parts of the line from a violation of the baseline to the finding of its basin."""


def examined(run: Run) -> bool:
    """Whether what is stated of the basins of cases is what evaluations show: a lowest cost is that of one, at the
    parameters that are stated, and no higher than the case that a descent began from; a violation is one. Since `WIDER`
    no minima count as one that are farther apart than cases at one place."""
    validated = run.claims["results"][-1]
    stored, baseline = validated.get("basins") or [], run.campaign.baseline
    if baseline is not None and _has_basins(run) and len(stored) != len(baseline.cases):
        return False
    if baseline is not None and run.wording >= limits.WIDER and validated["findings"]["distance"] > limits.SAME_PLACE:
        return False
    if not _compares(run) or not run.whole or baseline is None:
        return True
    return all(_seen(run, number) for number in range(len(stored)))


def _has_basins(run: Run) -> bool:
    """Whether the record must have what is known of the basins of the baseline's cases; earlier ones had none."""
    return run.whole and run.wording >= limits.BASINS


def _seen(run: Run, number: int) -> bool:
    basin = run.claims["results"][-1]["basins"][number]
    if not _between(run, number, basin.get("line")) or not _as_stated(run, number):
        return False
    lowest, violation = basin["lowest"], basin.get("violation")
    if violation is not None:
        _, costs, status = run.rows(violation["position"])
        k = violation["index"]
        if not (0 <= k < len(status) and status[k] == OK and costs[k] == violation["cost"] <= run.threshold):
            return False
    if lowest is None:
        return True
    here = (run.status == OK) & (run.raw == lowest)
    if basin.get("parameters") is not None and not run.calls.noisy:
        wanted = [basin["parameters"].get(path, math.nan) for path in run.bounds]
        at = (list(run.values(point).values()) for point in run.points[here])
        if not any(all(map(_near, wanted, values)) for values in at):
            return False
    again = run.claims["results"][position(run)]["cases"][number]
    plain = again["cost"] is not None and again.get("realisation") is None and not run.calls.noisy
    return bool(here.any()) and (not plain or lowest <= again["cost"])


def _as_stated(run: Run, number: int) -> bool:
    """Whether a case that was confirmed agrees, violates and is validated as its values show."""
    recorded, found = run.claims["results"][-1]["basins"][number].get("confirmed"), passing(run, number)
    if recorded is None or found is None:
        return recorded is found
    again, others = run.claims["results"][position(run)]["cases"][number], ("agrees", "violates", "ok")
    same = all(bool(recorded[name]) == bool(getattr(found, name)) for name in others)
    return same and recorded["cost"] == again["cost"] is not None


def passing(run: Run, number: int) -> Validation | None:
    """A case of the baseline that violates no more, by the values that other means gave it; None if it was not so
    confirmed."""
    basins = run.claims["results"][-1].get("basins") or []
    recorded = basins[number].get("confirmed") if number < len(basins) else None
    return None if recorded is None else run.case(recorded, OMIT, recorded["cost"])


def _confirmed(run: Run, number: int, case: BaselineCase) -> bool:
    """Whether it violates no more by any means, and in calls beyond chance: the probability that none of those here
    violates, if so many of both runs' calls do, is that of Fisher's exact test."""
    found = passing(run, number)
    if found is None or not found.agrees:
        return False
    calls = (run.claims["results"][-1]["basins"][number]["confirmed"].get("repeats") or {}).get("values")
    if calls is None or case.calls is None:
        return True
    chance, here = 1.0, len(calls)
    for k in range(sum(value <= run.threshold for value in case.calls.low)):
        chance *= (case.calls.made - k) / (case.calls.made + here - k)
    return chance <= limits.CHANCE * (1 + 1e-9)


def _between(run: Run, number: int, stated: Any) -> bool:
    """Whether the line from a case to a finding is stated as it was evaluated, and not left out if it was."""
    now = run.claims["results"][-1]["since"][number]
    finding = next((f["point"] for f in run.claims["findings"] if f["label"] == now), None)
    if finding is None:
        return stated is None
    begin = _begin(run, number)
    place = min(run.campaign.stages.findings.distance, limits.SAME_PLACE)
    whole = _along(run, begin, np.array(finding))
    if stated is None:
        return whole is None or not _decides(run, number, now) or float(np.abs(begin - finding).max()) < place
    end = np.array(stated["end"])
    costs, moved = _along(run, begin, end), float(np.abs(end - finding).max())
    if costs is None or moved >= place or (whole is not None and moved > 0.0):
        return False
    highest = float(costs.max())
    return bool((highest if math.isfinite(highest) else None) == stated["highest"])


def _begin(run: Run, number: int) -> Any:
    """The point of a case of the baseline, as evaluated."""
    return np.array(run.claims["results"][position(run)]["cases"][number]["point"], dtype=np.float64)


def _decides(run: Run, number: int, now: str) -> bool:
    """Whether a case violated in the baseline, and the finding of its basin does here."""
    baseline, there = run.campaign.baseline, next(f for f in run.findings if f.label == now)
    return baseline is not None and baseline.cases[number].cost <= run.threshold and there.cost <= run.threshold


def _along(run: Run, begin: Any, end: Any) -> Any:
    """The costs of the cases between two points, infinite without one; None if they are not all evaluated."""
    points, costs, status = run.rows(len(run.plan) - 1)
    found = []
    for part in range(1, LINE):
        at = begin + part / LINE * (end - begin) if begin.shape == end.shape else end
        rows = np.flatnonzero((np.abs(points - at) <= NEAR).all(axis=1))
        if begin.shape != end.shape or not len(rows):
            return None
        found.append(float(costs[rows[0]]) if status[rows[0]] == OK else math.inf)
    return np.array(found)


def _near(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-15)


def regression(run: Run, checks: dict[str, bool]) -> Regression:
    """What has become of every finding of either run; checks: whether each holds."""
    stated, policy = run.claims["regression"], run.campaign.regression
    cases = [_case(run, number) for number in range(len(stated["cases"]))]
    violations = [case for case in cases if (case.margin or 0.0) <= 0]
    known = bool(violations) and not any(case.newly_violating for case in violations)
    strictest = _thresholds(run)[1] - run.threshold
    rows = [changed(case, fails=_fails(run, policy.fail_on, case, strictest)) for case in cases]
    baseline = run.campaign.baseline
    assert baseline is not None
    left_out = {finding.label for finding in run.findings} - {recorded["now"] for recorded in stated["cases"]}
    left_out |= {case.label for case in baseline.cases} - {recorded["before"] for recorded in stated["cases"]}
    names = [(recorded["before"], recorded["before"] or recorded["now"]) for recorded in stated["cases"]]
    again = [label for label, times in Counter(names).items() if times > 1]
    others: list[Any] = [*sorted(left_out), *again]  # another count
    accepted = "violation" not in policy.fail_on and known and (run.wording < limits.BESIDE or _alone(run, checks))
    basis = (OMIT, OMIT, OMIT)
    if _compares(run):
        basis = ([*policy.fail_on], run.quantity, run.unit)
    return made(
        Regression, fail_on=basis[0], quantity=basis[1], unit=basis[2], run=baseline.run, position=position(run),
        cases=[*rows, *(made(FindingChange, before=before, **REST) for before in others)],
        ok=not any(row.fails for row in rows), accepted=accepted,
    )  # fmt: skip


def _alone(run: Run, checks: dict[str, bool]) -> bool:
    """Whether nothing but violations is wrong, and all findings that violate are listed."""
    listed = len(run.findings) < run.campaign.stages.findings.at_most or any(f.margin > 0 for f in run.findings)
    return listed and all(holds or _of_violations(run, name) for name, holds in checks.items())


def _of_violations(run: Run, name: str) -> bool:
    """Whether violations alone make a check fail."""
    if name in ("probability", "target"):
        return run.claimed is not None and run.claimed.violations > 0
    if name == "noise of calls":
        return run.calls.beside(run.claimed.noise if run.claimed else "stated")
    return name in limits.OF_VIOLATIONS


def _case(run: Run, number: int) -> FindingChange:
    """The case of one row, NaN where there is no number; before and now are taken as given."""
    recorded = run.claims["regression"]["cases"][number]
    if recorded["before"] is None:
        found = {f.label: f for f in run.findings}[recorded["now"]]
        margin = found.margin if run.wording >= limits.CALLED else found.cost - run.threshold
        identity, margins = (None, found.label, found.parameters), (math.nan, math.nan, margin)
        return _row(run, "new", margins, identity, new=margin <= 0)
    baseline = run.campaign.baseline
    assert baseline is not None
    case = next(case for case in baseline.cases if case.label == recorded["before"])
    known = {other.label: _basin(run, number) for number, other in enumerate(baseline.cases)}
    at = [other.label for other in baseline.cases].index(case.label)
    own, limit = known[case.label], run.threshold
    basin, stands = own.cost, True
    if own.now is not None or math.isfinite(basin):  # the lowest finding of the baseline represents a basin
        same = [o for o in baseline.cases if known[o.label].now == own.now and known[o.label].cost == basin]
        stands = case.stated <= min(other.stated for other in same)
    _, costs, status = run.rows(position(run))
    index = {one["label"]: one["index"] for one in run.claims["results"][position(run)]["cases"]}
    before, k = case.stated, index[case.label] if _compares(run) else recorded["evaluation"]
    if k is None or status[k] != OK:
        return _row(run, "not compared", (before - limit, math.nan, math.nan), (k, None, case.parameters))
    again = float(costs[k])
    lowest = min(again, basin) if stands else again
    tolerance = _tolerance(run, case, recorded["now"])
    violated = before <= _thresholds(run)[0]
    new = lowest <= limit and not violated
    if violated and lowest > limit:
        repeating = (run.claims["results"][-1]["nominal"] or {}).get("repeats") is None
        shown = own.examined and (run.wording >= limits.EACH or case.called is None or own.now is not None or repeating)
        standing = "better" if basin <= limit or own.violates else "fixed" if shown else "unresolved"
    else:
        allowed = max(tolerance, _apart(run, before, lowest))
        worse = new or again < before - tolerance or lowest < before - allowed
        standing = "worse" if worse else "better" if lowest > before + tolerance else "same"
    passes = violated and again > limit and standing in ("fixed", "better")
    if passes and run.wording >= limits.EACH and _has_basins(run) and not _confirmed(run, at, case):
        standing = "unresolved"
    place = own.parameters if stands and basin < again else run.values(run.rows(position(run))[0][k])
    margins = before - limit, again - limit, lowest - limit
    return _row(run, standing, margins, (k, own.now, place), tolerance, new, lowest - before)


def _compares(run: Run) -> bool:
    """Whether the record states all that its comparison rests on; those of earlier versions are judged by less."""
    return run.wording >= limits.BASELINES


def _row(
    run: Run, standing: Any, margins: tuple[float, float, float],
    identity: tuple[int | None, str | None, Mapping[str, float]],
    tolerance: float = math.nan, new: bool = False, change: float = math.nan,
) -> FindingChange:  # fmt: skip
    """A row with its margins before, again and lowest; identity: the evaluation, the finding and the parameters that it
    names, by which earlier versions are not judged."""
    evaluation, now, parameters = (*identity[:2], dict(identity[2])) if _compares(run) else (OMIT, OMIT, OMIT)
    return made(
        FindingChange, standing=standing, margin_before=margins[0], margin_again=margins[1], margin=margins[2],
        change=change, tolerance=tolerance, newly_violating=new, evaluation=evaluation, now=now, parameters=parameters,
        **REST,
    )  # fmt: skip


class Basin(NamedTuple):
    """What the record has of the basin of a case: the finding there and the lowest cost, whether it violates and was
    searched, and where."""

    now: str | None
    cost: float
    violates: bool
    examined: bool
    parameters: Mapping[str, float]


def _basin(run: Run, number: int) -> Basin:
    """That of one case of the baseline, which is alone if one between it and the finding is clear; earlier versions
    stored the finding only."""
    validated, again = run.claims["results"][-1], run.claims["results"][position(run)]["cases"][number]
    now = validated["since"][number]
    there = next((f for f in run.findings if f.label == now), None)
    listed, at = (math.inf, {}) if there is None else (there.cost, there.parameters)
    if there is not None and run.wording >= limits.GRANTED:
        listed = min(there.cost, run.granted(there))
    if not validated.get("basins"):
        return Basin(now, listed, violates=False, examined=not _has_basins(run), parameters=at)
    stored = validated["basins"][number]
    if now is not None and stored.get("line") is not None and not _one(run, number, now, stored["line"]["highest"]):
        return Basin(None, again["cost"], "violation" in stored, not stored["not_compared"], again["parameters"])
    known = stored["lowest"] is not None
    cost = stored["lowest"] if known and now is None else listed
    examined = known and not stored["not_compared"]
    return Basin(now, cost, "violation" in stored, examined, at or stored.get("parameters") or {})


def _one(run: Run, number: int, now: str, highest: float | None) -> bool:
    """Whether a case of the baseline and a finding are one, from the highest cost between them."""
    baseline, stage = run.campaign.baseline, position(run)
    assert baseline is not None
    k = run.claims["results"][stage]["cases"][number]["index"]
    most = max(run.threshold, float(run.rows(stage)[1][k])) + _tolerance(run, baseline.cases[number], now)
    return highest is not None and highest <= most


def _tolerance(run: Run, case: BaselineCase, label: str | None) -> float:
    validations = {f["label"]: f["validation"] for f in run.claims["findings"]}
    now = validations.get(label) if label else run.claims["results"][-1]["nominal"]
    others = [(now or {}).get(name) or {} for name in ("half_step", "integrator", "again")]
    apart = [abs(other["difference"]) for other in others if other.get("difference") is not None]
    spread = (run.claims["results"][0].get("measured") or {}).get("spread") or 0.0
    nominal = 0.0 if math.isnan(run.nominal) else run.nominal
    floor = limits.ROUNDING * max(abs(run.threshold), abs(nominal))
    if run.wording >= limits.WIDER:
        floor = _rounding(run, case.stated)
    return float(max([case.difference, *apart, spread, run.campaign.regression.tolerance, floor]))


def _rounding(run: Run, cost: float) -> float:
    """The change of a cost that is rounding: by the size of what is compared, no more than a tenth of its margin."""
    size, tenth = max(abs(cost), abs(run.threshold)), limits.TOLERANCE_OF_MARGIN * abs(cost - run.threshold)
    return max(min(limits.ROUNDING * size, tenth), limits.AGREEMENT_ROUNDING * size)


def _apart(run: Run, before: float, lowest: float) -> float:
    """By how much two searches of one model may end apart: NaN without a nominal cost. Since `WIDER` by the costs that
    are compared, and no more than a tenth of the margin; before by nominal minus worst alone."""
    fall = max(run.nominal - lowest, 0.0)
    if run.wording < limits.WIDER:
        return limits.SAME_COST * fall
    size, tenth = max(map(abs, (before, lowest, run.threshold))), abs(before - run.threshold)
    return min(limits.SAME_COST * min(fall, size), limits.TOLERANCE_OF_MARGIN * tenth)


def _thresholds(run: Run) -> list[float]:
    """Of both runs, the lower one first; earlier versions knew that of this run only."""
    baseline = run.campaign.baseline
    return sorted((baseline.threshold if baseline is not None and _compares(run) else run.threshold, run.threshold))


def _fails(run: Run, fail_on: list[FailOn], case: FindingChange, strictest: float) -> bool:
    if case.standing in ("not compared", "unresolved"):
        violated = (case.margin_before or 0.0) <= strictest
        violated = violated and (case.standing == "not compared" or run.wording >= limits.EACH)
        return "not_compared" in fail_on or ("violation" in fail_on and violated)
    kinds = {str(case.standing), *(["new_violation"] if case.newly_violating else [])}
    return bool(kinds & {"new", "worse", "new_violation"} & set(fail_on))
