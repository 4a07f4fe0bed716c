"""Recomputes the comparison with a baseline: margins, changes, tolerances, standings, and what follows from the policy.

Taken as given: which finding of this run is in the basin of one of the baseline, which of the evaluations is the lowest
there, and between which stored violations and a case no barrier was found.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

from campaigns.asked.regression import BaselineCase
from campaigns.claims.stages import earlier_run
from campaigns.results.base import OK, STATUS
from worker.evidence.audit import limits
from worker.evidence.audit.recompute import Run, Tree


def position(run: Run) -> int:
    """Where the plan has the stage that evaluates the findings of the baseline."""
    return [planned.kind for planned in run.plan].index("baseline")


def evaluated(run: Run) -> Tree:
    """The result of that stage, from the campaign's baseline and the evaluations."""
    baseline, stated = run.campaign.baseline, run.claims["results"][position(run)]["cases"]
    assert baseline is not None
    by_label = {recorded["label"]: recorded for recorded in stated}
    cases = [_evaluated(run, case, by_label.get(case.label, {})) for case in baseline.cases]
    if not _compares(run):
        return {"cases": [{"label": case["label"], "cost": case["cost"]} for case in cases]}
    of = [
        earlier_run.Case(c["label"], c["index"] is not None, c["status"] == STATUS[OK], r["reason"], r["assumed"])
        for c, r in zip(cases, stated, strict=True)
    ]
    statement = earlier_run.evaluated(baseline.run, of, (baseline.threshold, run.threshold), run.unit)
    return {"run": baseline.run, "cases": cases} | ({} if run.reworded else {"statement": statement})


def _evaluated(run: Run, case: BaselineCase, recorded: Tree) -> Tree:
    """One finding of the baseline; the evaluation that its row names must be there, or its parameters impossible."""
    points, costs, status = run.rows(position(run))
    k = recorded.get("index")
    found: Tree = {"label": case.label, "realisation": None if k is None else case.realisation}
    if k is None:
        index = "an evaluation" if _possible(run, case) else None
        missing: Tree = {"parameters": dict(case.parameters), "point": [], "status": None, "cost": math.nan}
        return found | missing | {"index": index}
    ok = status[k] == OK
    return (
        found
        | {
            "index": k,
            "parameters": run.values(points[k]),
            "point": points[k].tolist(),
            "status": dict(enumerate(STATUS)).get(int(status[k])),
            "cost": float(costs[k]) if ok else math.nan,
            "assumed": [path for path in run.bounds if path not in case.parameters],
        }
        | ({"reason": ""} if ok else {})
    )


def _possible(run: Run, case: BaselineCase) -> bool:
    """Whether this campaign can have the parameters of a finding of the baseline, and its noise."""

    def fits(path: str, value: float) -> bool:
        if path not in run.known:
            return False
        if path not in run.bounds:
            return float(run.known[path][1]) == value
        low, high = run.bounds[path]
        return low <= value <= high

    noise = case.realisation is None or bool(run.random)
    return noise and all(fits(path, value) for path, value in case.parameters.items())


def examined(run: Run) -> bool:
    """Whether what is stated of the basins of cases is what evaluations show: a lowest cost is that of one, at the
    parameters that are stated, and no higher than the case that a descent began from; a violation is one."""
    validated = run.claims["results"][-1]
    stored = validated.get("basins") or []
    if not _compares(run) or not run.sealed or run.campaign.baseline is None or not stored:
        return True
    return all(_seen(run, number, basin) for number, basin in enumerate(stored))


def _seen(run: Run, number: int, basin: Tree) -> bool:
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


def _near(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-15)


def regression(run: Run, checks: dict[str, bool]) -> Tree:
    """What has become of every finding of either run; checks: whether each holds."""
    stated, policy = run.claims["regression"], run.campaign.regression
    cases = [_case(run, recorded) for recorded in stated["cases"]]
    violations = [case for case in cases if case["margin"] <= 0]
    known = bool(violations) and not any(case["newly_violating"] for case in violations)
    strictest = _thresholds(run)[1] - run.threshold
    failing = [_fails(policy.fail_on, case, strictest) for case in cases]
    rows = [case | {"fails": fails} for case, fails in zip(cases, failing, strict=True)]
    baseline = run.campaign.baseline
    assert baseline is not None
    left_out = {finding["label"] for finding in run.findings} - {recorded["now"] for recorded in stated["cases"]}
    left_out |= {case.label for case in baseline.cases} - {recorded["before"] for recorded in stated["cases"]}
    names = [(recorded["before"], recorded["before"] or recorded["now"]) for recorded in stated["cases"]]
    again = [label for label, times in Counter(names).items() if times > 1]
    basis = {"fail_on": [*policy.fail_on], "quantity": run.quantity, "unit": run.unit} if _compares(run) else {}
    return basis | {
        "run": baseline.run,
        "position": position(run),
        "cases": [*rows, *({"before": label} for label in [*sorted(left_out), *again])],  # another count
        "ok": not any(failing),
        "accepted": "violation" not in policy.fail_on
        and known
        and (run.wording < limits.BESIDE or _alone(run, checks)),
    }


def _alone(run: Run, checks: dict[str, bool]) -> bool:
    """Whether nothing but violations is wrong, and all findings that violate are listed."""
    listed = len(run.findings) < run.campaign.stages.findings.at_most or any(f["margin"] > 0 for f in run.findings)
    return listed and all(holds or _of_violations(run, name) for name, holds in checks.items())


def _of_violations(run: Run, name: str) -> bool:
    """Whether violations alone make a check fail."""
    if name in ("probability", "target"):
        return run.claimed is not None and run.claimed["violations"] > 0
    if name == "noise of calls":
        return run.calls.beside(run.claimed["noise"] if run.claimed else "stated")
    return name in limits.OF_VIOLATIONS


def _case(run: Run, recorded: Tree) -> Tree:
    """The case of one row, NaN where there is no number; before and now are taken as given."""
    found: Any = next((f for f in run.findings if f["label"] == recorded["now"]), None)
    if recorded["before"] is None:
        row = _row("new", math.nan, math.nan, found["margin"], math.nan, found["margin"] <= 0)
        return row | _row_identity(run, None, found["label"], found["parameters"])
    baseline = run.campaign.baseline
    assert baseline is not None
    case = next(case for case in baseline.cases if case.label == recorded["before"])
    known = {other.label: _basin(run, number) for number, other in enumerate(baseline.cases)}
    own, limit = known[case.label], run.threshold
    basin, stands = own["cost"], True
    if own["now"] is not None or math.isfinite(basin):  # the lowest finding of the baseline represents a basin
        same = [o for o in baseline.cases if all(known[o.label][k] == own[k] for k in ("now", "cost"))]
        stands = case.cost <= min(other.cost for other in same)
    _, costs, status = run.rows(position(run))
    index = {one["label"]: one["index"] for one in run.claims["results"][position(run)]["cases"]}
    before, k = case.cost, index[case.label] if _compares(run) else recorded["evaluation"]
    if k is None or status[k] != OK:
        row = _row("not compared", before - limit, math.nan, math.nan, math.nan, False)
        return row | _row_identity(run, k, None, case.parameters)
    again = float(costs[k])
    lowest = min(again, basin) if stands else again
    tolerance = _tolerance(run, case.difference, recorded["now"])
    violated = before <= _thresholds(run)[0]
    new = lowest <= limit and not violated
    if violated and lowest > limit:
        standing = "better" if basin <= limit or own["violates"] else "fixed" if own["examined"] else "unresolved"
    else:
        allowed = max(tolerance, limits.SAME_COST * max(run.nominal - lowest, 0.0))
        worse = new or again < before - tolerance or lowest < before - allowed
        standing = "worse" if worse else "better" if lowest > before + tolerance else "same"
    place = own["parameters"] if stands and basin < again else run.values(run.rows(position(run))[0][k])
    row = _row(standing, before - limit, again - limit, lowest - limit, tolerance, new)
    return row | _row_identity(run, k, own["now"], place) | {"change": lowest - before}


def _compares(run: Run) -> bool:
    """Whether the record states all that its comparison rests on; those of earlier versions are judged by less."""
    return run.wording >= limits.BASELINES


def _row_identity(run: Run, evaluation: int | None, now: str | None, parameters: Any) -> Tree:
    """What a row names besides its numbers; earlier versions are not judged by it."""
    return {"evaluation": evaluation, "now": now, "parameters": dict(parameters)} if _compares(run) else {}


def _basin(run: Run, number: int) -> Tree:
    """What the record has of the basin of one case of the baseline; earlier versions stored the finding only."""
    validated = run.claims["results"][-1]
    now = validated["since"][number]
    there: Tree = next((f for f in run.findings if f["label"] == now), {})
    listed, at = there.get("cost", math.inf), there.get("parameters", {})
    if not validated.get("basins"):
        return {"now": now, "cost": listed, "violates": False, "examined": True, "parameters": at}
    stored = validated["basins"][number]
    known = stored["lowest"] is not None
    cost = stored["lowest"] if known and now is None else listed
    examined = known and not stored["not_compared"]
    at = at or stored.get("parameters") or {}
    return {"now": now, "cost": cost, "violates": "violation" in stored, "examined": examined, "parameters": at}


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


def _thresholds(run: Run) -> list[float]:
    """Of both runs, the lower one first; earlier versions knew that of this run only."""
    baseline = run.campaign.baseline
    return sorted((baseline.threshold if baseline is not None and _compares(run) else run.threshold, run.threshold))


def _fails(fail_on: list[Any], case: Tree, strictest: float) -> bool:
    if case["standing"] == "not compared":
        return "not_compared" in fail_on or ("violation" in fail_on and case["margin_before"] <= strictest)
    if case["standing"] == "unresolved":
        return "not_compared" in fail_on
    kinds = {case["standing"], *(["new_violation"] if case["newly_violating"] else [])}
    return bool(kinds & {"new", "worse", "new_violation"} & set(fail_on))
