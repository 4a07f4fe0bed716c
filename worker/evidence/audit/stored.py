"""What a record states that follows from its evaluations and findings alone: counts, the lowest, how stages ended."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from campaigns.results.base import OK, STATUS
from campaigns.stages.plan import most
from worker.evidence.audit.recompute import Run, Tree
from worker.evidence.audit.record import MISSING


def of_evaluations(run: Run) -> Tree:
    """The claims that follow from the evaluations and findings alone."""
    method = finder(run)
    worst = {"cost": run.stated, "margin": run.stated - run.threshold, "method": method}
    beside = run.made["evaluations"] - len(run.status)
    total = {"stored": len(run.status), "lowest": run.lowest} | ({"counted": beside} if beside else {})
    total |= {name: run.made[name] for name in ("succeeded", "failed", "excluded", "violating")}
    stages = zip(run.plan, run.best, run.ended, strict=True)
    stops = [_stop(run, k) for k in range(len(run.plan))]
    expected: Tree = {
        "sound": bool((((run.status == OK) == np.isfinite(run.raw)) & (run.status < len(STATUS))).all()),
        "placed": bool((np.abs(run.points - 0.5) <= 0.5 + 1e-9).all() and (run.stage < len(run.plan)).all()),
        "stages": [
            {"kind": s.kind, "method": s.method, "best": best} | ended | stop
            for (s, best, ended), stop in zip(stages, stops, strict=True)
        ],
        "evaluations": total,
        "nominal": {"cost": run.nominal, "margin": run.nominal - run.threshold},
        "worst": worst if len(run.costs) else None,
        "findings": run.findings,
        "verdict": "violated" if run.confirmed else MISSING,
    }
    if "run" in run.claims if run.sealed else "quantity" in run.claims:  # the table of runs has the whole verdict
        expected |= {"provenance": {"seed": run.campaign.seed}, "quantity": run.quantity, "unit": run.unit}
    elif run.sealed or "seed" in run.claims:
        expected["seed"] = run.campaign.seed
    if run.flaky is not MISSING and (run.flaky or "flaky" in run.claims["evaluations"]):
        expected["evaluations"]["flaky"] = run.flaky
    if "run" in run.claims:  # the columns of the database's table of runs
        expected["run"] = {"threshold": run.threshold, "nominal_cost": run.nominal, "worst_cost": run.stated}
        expected["run"] |= {"evaluations": run.made["evaluations"], "failed_evaluations": run.made["failed"]}
        for k, stage in enumerate(run.claims["stages"]):
            if blocks := run.counted.get(k):  # a row has the stored ones, and how many there are beside them
                stored = int((run.stage == k).sum())
                expected["stages"][k] |= {"evaluations": stored, "counted": run.ended[k]["evaluations"] - stored}
                expected["stages"][k] |= {"violations": sum(blocks["violations"])}
            elif "counted" in stage:  # tables of earlier versions have no such columns
                expected["stages"][k] |= {"counted": 0, "violations": 0}
        expected["run"] |= {"worst_method": method, "upper_bound": run.bound}
        if run.sealed:
            expected["run"] |= {"planned": most(run.campaign), "state": "done", "error": None}
    return expected


def finder(run: Run) -> str | None:
    """The method that found the worst case; of those that did the one with the lowest best, else the quickest.

    Earlier versions named the method with the lowest best, whoever found it.
    """
    searched = [k for k in run.searches if not math.isnan(run.best[k])]
    lowest = run.plan[min(searched, key=run.best.__getitem__)].method if searched else None
    worst = run.worst or next(iter(run.findings), None)
    if worst is None or (run.claims.get("worst") or {}).get("method") == lowest:
        return lowest
    stated = next(one for one, made in zip(run.claims["findings"], run.findings, strict=True) if made is worst)
    drawn = (stated.get("validation") or {}).get("realisation") is not None
    by = sorted(() if drawn else stated.get("found") or (), key=lambda one: one["evaluations"])
    found = [run.plan[one["position"]].method for one in by]
    return lowest if lowest in found else next(iter(found), None)


def _stop(run: Run, k: int) -> Tree:
    """How a stage of a folder ended, and its minima, which repeat its result; in a database, what its row repeats."""
    results = run.claims.get("results") or []
    if not run.sealed:
        return {}
    if k >= len(results) or "run" in run.claims:
        best = lowest_of(run, k)
        return {"planned": run.plan[k].planned, "best_index": best and best["index"]}
    result = results[k] or {}
    return {"stop": (result.get("stop") or {}).get("text"), "minima": result.get("minima") or []}


def lowest_of(run: Run, k: int) -> Any:
    """The lowest evaluation of a search, the first of equal ones."""
    if math.isnan(run.best[k]):
        return None
    points, raw, status = run.rows(k)
    index = int(np.argmin(np.where(status == OK, raw, np.inf)))
    best = {"cost": run.best[k], "margin": run.best[k] - run.threshold}
    return best | {"index": index, "parameters": run.values(points[index])} if run.sealed else best
