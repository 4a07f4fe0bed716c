"""What a record states that follows once the results of its stages and the catalogue are also used.

Start reading at `of_results`; a stage whose result has rules of its own has a module of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from campaigns.asked.allowance import validation
from campaigns.claims.stages.surroundings import possible_gain
from campaigns.results.base import OK, STATUS
from campaigns.results.draws import of_indices
from worker.evidence.audit import charts, counted, limits, modes
from worker.evidence.audit.agreement import apart, family
from worker.evidence.audit.attraction import attracted
from worker.evidence.audit.checks import as_stated, left_out, required_checks
from worker.evidence.audit.estimate import estimated
from worker.evidence.audit.finders import found_by, gathered, noise
from worker.evidence.audit.likelihood import likely
from worker.evidence.audit.points import grid
from worker.evidence.audit.recompute import Run, Tree
from worker.evidence.audit.record import MISSING
from worker.evidence.audit.regression import evaluated, examined, position, regression
from worker.evidence.audit.sentences import of_sample, of_stage
from worker.evidence.audit.stored import finder, lowest_of
from worker.evidence.audit.sureness import sureness

BESIDE = ("outside", "lowest", "mean", "deviation", "histogram", "distribution", "looks")
"""Fields of a sample that the statistics of the verdict do not have."""


def of_results(run: Run, at_most: int, spot_checks: int) -> Tree:
    """The claims that follow if the results of the stages and the catalogue are also used."""
    nominal = {"name": "nominal", "cost": run.nominal} | run.case(run.claims["results"][-1]["nominal"])
    agreed = bool(nominal["ok"]) and all(f["validation"]["ok"] for f in run.findings)
    below = [{"position": k, "count": n} for k, n in enumerate(run.below) if n]
    out = left_out(run)
    checked = min(sum(run.below), at_most) - out.get("violations", 0)
    violations = {"stored": sum(run.below), "by_stage": below, "checked": checked}
    spread = {"evaluations": len(run.costs), "lowest": run.lowest, "highest": run.highest}
    last: Tree = {"nominal": nominal, "ok": agreed, "violations": violations, "encounter": {"spread": spread}}
    last |= {"spot_checks": {"checked": min(spot_checks, len(run.costs)) - out.get("spot_checks", 0)}}
    if run.sealed:
        allowed = validation(run.campaign, run.calls.noisy).total
        validate, findings = run.campaign.stages.validate_, run.campaign.stages.findings
        settings = {name: getattr(findings, name) for name in ("distance", "barrier", "at_most")}
        last |= {"tolerance": validate.tolerance, "findings": settings} | modes.named(run)
        last["spent"] = {"at_most": allowed, "stored": run.ended[-1]["evaluations"]}  # the rest was evaluated again
        last["findings"] |= gathered(run)
    if run.claims["results"][-1]["encounter"].get("beyond") is not None:
        last["encounter"]["beyond"] = {"times": limits.CONTINUED, "flights": _continued(run)}
    results: list[Tree] = [_stage(run, k) for k in range(len(run.plan) - 1)]
    rows, known = [], {finding["label"] for finding in run.findings}
    for k, compared in zip(run.searches, run.claims["comparison"], strict=True):
        spent = run.ended[k]["evaluations"] >= run.plan[k].planned
        results[k] |= run.ended[k] | {"stop": {"kind": "budget" if spent else "rule"} | results[k].get("stop", {})}
        method = {"method": run.plan[k].method, "title": run.methods[k].title, "kind": run.methods[k].kind}
        results[k] |= method | {"best": lowest_of(run, k)} | (_charts(run, k) if run.sealed else {})
        rows.append({"position": k, "best": run.best[k]} | method | run.ended[k])
        rows[-1]["findings"] = [label for label in compared["findings"] if label in known]
        if run.sealed:
            rows[-1]["stop"] = run.claims["results"][k]["stop"]
            by = [(f["label"], [one["position"] for one in f.get("found") or ()]) for f in run.claims["findings"]]
            rows[-1]["findings"] = [label for label, positions in by if k in positions]
    checks = required_checks(run, agreed)
    sample = run.claimed and {k: v for k, v in run.claimed.items() if k not in BESIDE}
    if sample and run.sealed:
        sample["source"] = "certify" if any(stage.kind == "certify" for stage in run.plan) else "search"
    if run.campaign.baseline is not None:
        results[position(run)] |= evaluated(run)
    if run.calls.measures:
        results[0]["measured"] = run.calls.measured
    if run.calls.noisy:
        best = zip([k for k in run.searches if not math.isnan(run.best[k])], _incumbents(run), strict=False)
        incumbents = [{"position": k, "cost": run.best[k], "validation": {"cost": run.best[k]} | v} for k, v in best]
        last["incumbents"] = incumbents
    if run.sealed:
        last["comparison"] = [dict(row) for row in run.claims["comparison"]]
    expected: Tree = {"results": [*results, last], "comparison": rows, "checks": checks, "statistics": sample}
    expected["possible"] = _possible(run)
    if run.campaign.baseline is not None:
        expected["regression"] = regression(run, as_stated(run) | checks)
    if run.sealed:
        pairs = zip(run.findings, run.claims["findings"], strict=True)
        expected["findings"] = [found | _found(run, found, recorded) for found, recorded in pairs]
        expected |= likely(run, expected["findings"])
    if run.sealed and run.findings:
        expected["worst"] = _worst(run)
    if not run.reworded and (run.sealed or "sureness" in run.claims):
        expected["sureness"] = sureness(run)
    if not run.confirmed:
        stated = as_stated(run)
        clear = all((stated | checks).values()) and stated.keys() >= checks.keys()
        expected["verdict"] = "cleared" if clear else "inconclusive"
    return expected


def _possible(run: Run) -> bool:
    """Whether what validation counted, as taken, is no more than what it counted of."""
    last = run.claims["results"][-1]
    spot, violations = last["spot_checks"], last["violations"]
    of = [
        (0, spot["compared"], spot["checked"]),
        (0, spot["violating"], spot["checked"]),
        (0, violations["confirmed"], violations["checked"]),
        (0, violations["checked"], violations["stored"]),
        *((0, left, math.inf) for left in left_out(run).values()),
    ]
    return examined(run) and all(low <= count <= most for low, count, most in of)


def _continued(run: Run) -> int:
    """The flights that are simulated on: nominal case, findings and sample, under each of their realisations."""
    findings, each = run.claims["findings"], len(run.campaign.given_scenario.realisations.seeds)
    own = sum(f["validation"]["realisation"] is not None for f in findings)
    total = own + each * (1 + len(findings) - own)
    for k in (k for k, planned in enumerate(run.plan) if planned.kind == "certify"):
        succeeded, drawn = run.status[run.stage == k] == OK, run.claims["results"][k]["drawn_realisations"]
        total += int(succeeded[:drawn].sum()) + each * int(succeeded[drawn:].sum())
    return total


def _stage(run: Run, k: int) -> Tree:
    """What the result of a stage states, as far as its evaluations and the campaign decide it."""
    if k == 0:
        return _nominal(run, run.claims["results"][0]) if run.sealed else {}
    sample = run.samples.get(k)
    if run.plan[k].kind == "sensitivity" and run.sealed:
        request = run.campaign.stages.sensitivity
        return {"curves": charts.curves(run, k)} | ({} if request is None else {"points": request.points})
    if run.plan[k].kind == "estimate":
        return estimated(run, k)
    if run.plan[k].kind == "attraction":
        return attracted(run, k)
    if sample is None:
        return {"sample": None} if k in run.searches else {}
    if not run.sealed:
        return {"sample": sample}
    made = of_sample(run, k, sample)
    full_sample = sample | made | ({"quantile": sample["quantile"] | made["quantile"]} if "quantile" in made else {})
    found: Tree = {"sample": full_sample} | of_stage(run, k, full_sample, (run.claims["results"][k] or {}).get("stop"))
    if run.plan[k].kind == "certify":
        found |= run.ended[k] | {"grid": grid(run, k) if run.grid(k) else None}
        found |= _blocks(run, k)
    return found


def _blocks(run: Run, k: int) -> Tree:
    """What a sample of which only the lowest are stored states of its blocks and of the noise of its flights."""
    certify, result = run.campaign.stages.certify, run.claims["results"][k]
    if certify is None or certify.keep == "all":
        return {"blocks": None, "flights": None, "realisations": None}
    flights, (_, raw, status) = np.array(result["flights"], dtype=np.int64), run.rows(k)
    seeds = of_indices(int(result["seed"]), flights).tolist() if run.random else None
    before = run.raw[(run.stage < k) & (run.status == OK)].tolist()
    beside = counted.beside(run.counted[k], int(np.count_nonzero(raw[status == OK] <= run.threshold)), status)
    sentence = {} if run.reworded else {"statement": counted.statement(run.counted[k], len(status))}
    return {"blocks": counted.scale(before, run.threshold) | {"beside": beside} | sentence, "realisations": seeds}


def _nominal(run: Run, stated: Tree) -> Tree:
    """The nominal case; earlier versions stored no parameters of it."""
    first = run.stage == 0
    state = dict(enumerate(STATUS)).get(run.status[first][0])
    found: Tree = {"cost": run.nominal, "margin": run.nominal - run.threshold, "status": state}
    found |= {"parameters": run.values(run.points[first][0])} if stated.get("parameters") else {}
    return found | ({"reason": ""} if state == STATUS[OK] else {})


def _charts(run: Run, k: int) -> Tree:
    """What a search shows besides its best."""
    stated = run.claims["results"][k]
    found = charts.front(run, k) | {"minima": charts.minima(run, k, stated["minima"]), "family": family(run, k)}
    if stated.get("apart"):
        found["apart"] = apart(run, k)
    if stated.get("gap") and run.wording >= limits.BASELINES:
        found["gap"] = _gap(run, k, stated["gap"])
    return found


def _gap(run: Run, k: int, gap: Tree) -> Tree:
    """The sentence on DIRECT's possible gain; its lower bound and gap must end at the lowest value of the search, of
    earlier versions at that of some evaluation, and the gap is not negative."""
    _, raw, status = run.rows(k)
    best = gap["lower_bound"] + gap["gap"]  # the sum has lost digits
    known = raw[status == OK]
    if run.wording >= limits.LOWEST:
        known = np.array([run.best[k]])
    nearest = float(known[np.argmin(np.abs(known - best))]) if len(known) else math.nan
    lost = 4 * np.finfo(float).eps * max(abs(gap["lower_bound"]), abs(gap["gap"]))
    numbers = (gap["rectangles"], gap["without_value"], run.quantity, gap["lower_bound"], nearest, run.unit)
    found: Tree = {} if run.reworded else {"statement": possible_gain(*numbers)}
    found["rectangles"] = min(gap["rectangles"], run.ended[k]["evaluations"])
    return found if abs(nearest - best) <= lost and gap["gap"] >= 0.0 else found | {"lower_bound": math.nan}


def _found(run: Run, made: Tree, finding: Tree) -> Tree:
    """The slices of a finding, the methods that found it, each by its position, and its noise; made: what is known."""
    by = found_by(run, finding)
    found: Tree = {"found": by, "methods": list(dict.fromkeys(one["method"] for one in by))}
    found["validation"] = made["validation"] | noise(run, finding)
    return found | (
        {"slices": charts.slices(run, finding["point"], finding["slices"])} if finding.get("slices") else {}
    )


def _worst(run: Run) -> Tree:
    """The worst finding, or of a violated verdict the worst of those that were confirmed."""
    stated = run.worst or run.findings[0]
    found = {"cost": run.stated, "margin": run.stated - run.threshold, "method": finder(run)}
    found |= {"evaluated": stated["cost"], "parameters": stated["parameters"]}
    return found | ({"finding": stated["label"]} if "run" in run.claims else {})


def _incumbents(run: Run) -> Iterator[Tree]:
    """The independent calls of every search's best, recomputed; one too few is missing at the end."""
    stated = run.claims["results"][-1].get("incumbents", [])
    yield from (run.calls.case(best["validation"]) for best in stated)
    yield from ({"repeats": {"violating": MISSING}} for _ in range(len(run.searches) - len(stated)))
