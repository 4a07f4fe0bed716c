"""Recomputes the comparison with a baseline: margins, changes, tolerances, standings, and what follows from the policy.

Taken as given: which finding of this run is in the basin of one of the baseline, the lowest cost there, and between
which stored violations and a case no barrier was found.
"""

from __future__ import annotations

import math
from typing import Any

from campaigns.results.base import OK
from worker.evidence.audit import limits
from worker.evidence.audit.recompute import Run, Tree


def position(run: Run) -> int:
    """Where the plan has the stage that evaluates the findings of the baseline."""
    return [planned.kind for planned in run.plan].index("baseline")


def evaluated(run: Run) -> Tree:
    """The result of that stage, from its evaluations."""
    _, costs, status = run.rows(position(run))
    cases = []
    for recorded in run.claims["results"][position(run)]["cases"]:
        k = recorded["index"]
        known = k is not None and status[k] == OK
        cases.append({"label": recorded["label"], "cost": float(costs[k]) if known else math.nan})
    return {"cases": cases}


def regression(run: Run) -> Tree:
    """What has become of every finding of either run."""
    stated, policy = run.claims["regression"], run.campaign.regression
    cases = [_case(run, recorded) for recorded in stated["cases"]]
    violations = [case for case in cases if case["margin"] <= 0]
    known = bool(violations) and not any(case["newly_violating"] for case in violations)
    failing = [_fails(policy.fail_on, case) for case in cases]
    rows = [case | {"fails": fails} for case, fails in zip(cases, failing, strict=True)]
    baseline = run.campaign.baseline
    assert baseline is not None
    left_out = {finding["label"] for finding in run.findings} - {recorded["now"] for recorded in stated["cases"]}
    left_out |= {case.label for case in baseline.cases} - {recorded["before"] for recorded in stated["cases"]}
    return {
        "run": baseline.run,
        "position": position(run),
        "cases": [*rows, *({"before": label} for label in sorted(left_out))],  # another count
        "ok": not any(failing),
        "accepted": "violation" not in policy.fail_on and known,
    }


def _case(run: Run, recorded: Tree) -> Tree:
    """The case of one row, NaN where there is no number; before and now are taken as given."""
    found: Any = next((f for f in run.findings if f["label"] == recorded["now"]), None)
    if recorded["before"] is None:
        return _row("new", math.nan, math.nan, found["margin"], math.nan, found["margin"] <= 0)
    baseline = run.campaign.baseline
    assert baseline is not None
    case = next(case for case in baseline.cases if case.label == recorded["before"])
    known = {other.label: _basin(run, number) for number, other in enumerate(baseline.cases)}
    own = known[case.label]
    basin, stands = own["margin"], True
    if own["now"] is not None or math.isfinite(basin):  # the lowest finding of the baseline represents a basin
        same = [o for o in baseline.cases if all(known[o.label][k] == own[k] for k in ("now", "margin"))]
        stands = case.cost <= min(other.cost for other in same)
    _, costs, status = run.rows(position(run))
    before, k = case.cost - run.threshold, recorded["evaluation"]
    if k is None or status[k] != OK:
        return _row("not compared", before, math.nan, math.nan, math.nan, False)
    again = float(costs[k]) - run.threshold
    lowest = min(again, basin) if stands else again
    tolerance = _tolerance(run, case.difference, recorded["now"])
    new = lowest <= 0 < before
    if before <= 0 < lowest:
        standing = "better" if basin <= 0 or own["violates"] else "fixed" if own["examined"] else "unresolved"
    else:
        allowed = max(tolerance, limits.SAME_COST * max(run.nominal - run.threshold - lowest, 0.0))
        worse = new or again < before - tolerance or lowest < before - allowed
        standing = "worse" if worse else "better" if lowest > before + tolerance else "same"
    return _row(standing, before, again, lowest, tolerance, new) | {"change": lowest - before}


def _basin(run: Run, number: int) -> Tree:
    """What the record has of the basin of one case of the baseline; earlier versions stored the finding only."""
    validated = run.claims["results"][-1]
    now = validated["since"][number]
    listed: Any = next((f["margin"] for f in run.findings if f["label"] == now), math.inf)
    if not validated.get("basins"):
        return {"now": now, "margin": listed, "violates": False, "examined": True}
    stored = validated["basins"][number]
    known = stored["lowest"] is not None
    margin = stored["lowest"] - run.threshold if known and now is None else listed
    examined = known and not stored["not_compared"]
    return {"now": now, "margin": margin, "violates": "violation" in stored, "examined": examined}


def _row(standing: str, before: float, again: float, lowest: float, tolerance: float, new: bool) -> Tree:
    margins = {"margin_before": before, "margin_again": again, "margin": lowest}
    return {"standing": standing, **margins, "change": math.nan, "tolerance": tolerance, "newly_violating": new}


def _tolerance(run: Run, before: float, label: str | None) -> float:
    validations = {f["label"]: f["validation"] for f in run.claims["findings"]}
    now = validations.get(label) if label else run.claims["results"][-1]["nominal"]
    others = [(now or {}).get(name) or {} for name in ("half_step", "integrator", "again")]
    apart = [abs(other["difference"]) for other in others if other.get("difference") is not None]
    spread = (run.claims["results"][0].get("measured") or {}).get("spread") or 0.0
    nominal = 0.0 if math.isnan(run.nominal) else run.nominal
    floor = limits.ROUNDING * max(abs(run.threshold), abs(nominal))
    return float(max([before, *apart, spread, run.campaign.regression.tolerance, floor]))


def _fails(fail_on: list[Any], case: Tree) -> bool:
    if case["standing"] == "not compared":
        return "not_compared" in fail_on or ("violation" in fail_on and case["margin_before"] <= 0)
    if case["standing"] == "unresolved":
        return "not_compared" in fail_on
    kinds = {case["standing"], *(["new_violation"] if case["newly_violating"] else [])}
    return bool(kinds & {"new", "worse", "new_violation"} & set(fail_on))
