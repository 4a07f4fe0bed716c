"""What a record states that follows from its evaluations and findings alone: counts, the lowest, how stages ended."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from campaigns.results.base import OK, STATUS
from campaigns.results.search import Best
from campaigns.results.verdict import Counts, NominalCost, Provenance, Worst
from campaigns.stages.plan import most
from worker.evidence.audit.parts import OMIT, REST, made
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import MISSING


class Row(NamedTuple):
    """What a list of stages states of one; in a database, what its row repeats."""

    kind: str
    method: str | None
    best: float
    evaluations: int
    failed: int
    excluded: int
    planned: int = OMIT
    best_index: int | None = OMIT
    stop: str | None = OMIT
    minima: list[Any] = OMIT
    counted: int = OMIT
    violations: int = OMIT


def of_evaluations(run: Run) -> Iterator[tuple[str, object]]:
    """The claims that follow from the evaluations and findings alone, by name."""
    evaluations, failed, excluded = run.made
    yield "sound", bool((((run.status == OK) == np.isfinite(run.raw)) & (run.status < len(STATUS))).all())
    yield "placed", bool((np.abs(run.points - 0.5) <= 0.5 + 1e-9).all() and (run.stage < len(run.plan)).all())
    rows = len(run.claims["stages"]) if "run" in run.claims else 0
    yield "stages", [_row(run, k) for k in range(max(len(run.plan), rows))]
    flaky = run.flaky if run.flaky is not MISSING and (run.flaky or "flaky" in run.claims["evaluations"]) else OMIT
    total = made(
        Counts, stored=len(run.status), lowest=run.lowest, counted=evaluations - len(run.status) or OMIT,
        succeeded=run.succeeded, failed=failed, excluded=excluded, violating=run.violating, flaky=flaky,
    )  # fmt: skip
    yield "evaluations", total
    yield "nominal", made(NominalCost, cost=run.nominal, margin=run.nominal - run.threshold)
    worst = made(Worst, cost=run.stated, margin=run.stated - run.threshold, method=finder(run), **REST)
    yield "worst", worst if len(run.costs) else None
    yield "findings", run.findings
    yield "verdict", "violated" if run.confirmed else MISSING
    if "run" in run.claims if run.sealed else "quantity" in run.claims:  # the table of runs has the whole verdict
        yield "provenance", made(Provenance, seed=run.campaign.seed)
        yield from (("quantity", run.quantity), ("unit", run.unit))
    elif run.sealed or "seed" in run.claims:
        yield "seed", run.campaign.seed
    if "run" in run.claims:  # the columns of the database's table of runs
        columns = {"threshold": run.threshold, "nominal_cost": run.nominal, "worst_cost": run.stated}
        columns |= {"evaluations": evaluations, "failed_evaluations": failed}
        further = {"planned": most(run.campaign), "state": "done", "error": None} if run.sealed else {}
        yield "run", {**columns, "worst_method": finder(run), "upper_bound": run.bound, **further}


def finder(run: Run) -> str | None:
    """The method that found the worst case; of those that did the one with the lowest best, else the quickest.

    Earlier versions named the method with the lowest best, whoever found it.
    """
    searched = [k for k in run.searches if not math.isnan(run.best[k])]
    lowest = run.plan[min(searched, key=run.best.__getitem__)].method if searched else None
    if not run.findings or (run.claims.get("worst") or {}).get("method") == lowest:
        return lowest
    stated = run.claims["findings"][run.worst or 0]
    drawn = (stated.get("validation") or {}).get("realisation") is not None
    by = sorted(() if drawn else stated.get("found") or (), key=lambda one: one["evaluations"])
    found = [run.plan[one["position"]].method for one in by]
    return lowest if lowest in found else next(iter(found), None)


def _row(run: Run, k: int) -> Row:
    planned, results = run.plan[k], run.claims.get("results") or []
    row = Row(planned.kind, planned.method, run.best[k], *run.ended[k])
    if run.sealed and (k >= len(results) or "run" in run.claims):
        best = lowest_of(run, k)
        row = row._replace(planned=planned.planned, best_index=None if best is None else best.index)
    elif run.sealed:
        result = results[k] or {}
        row = row._replace(stop=(result.get("stop") or {}).get("text"), minima=result.get("minima") or [])
    if "run" not in run.claims or k >= len(run.claims["stages"]):
        return row
    if blocks := run.counted.get(k):  # a row has the stored ones, and how many there are beside them
        stored = int((run.stage == k).sum())
        return row._replace(evaluations=stored, counted=row.evaluations - stored, violations=sum(blocks.violations))
    # Tables of earlier versions have no such columns.
    return row._replace(counted=0, violations=0) if "counted" in run.claims["stages"][k] else row


def lowest_of(run: Run, k: int) -> Best | None:
    """The lowest evaluation of a search, the first of equal ones."""
    if math.isnan(run.best[k]):
        return None
    points, raw, status = run.rows(k)
    cost, index = run.best[k], int(np.argmin(np.where(status == OK, raw, np.inf)))
    if not run.sealed:
        return made(Best, cost=cost, margin=cost - run.threshold, **REST)
    return made(Best, cost=cost, margin=cost - run.threshold, index=index, parameters=run.values(points[index]))
