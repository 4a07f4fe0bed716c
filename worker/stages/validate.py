"""Validate: fly every distinct worst case again by other means before anything is claimed of it.

First `worker.stages.findings` tells the worst cases apart, polishes them and flies their neighbours; then each is flown
at half the step and with another integrator. Disagreement beyond tolerance is reported and bars "cleared".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from worker.problem import Floats
from worker.reference import NAME, Flight, Reference
from worker.search.base import OK
from worker.stages import boundary, findings
from worker.stages.base import Context, Driven, all_columns, drive
from worker.stages.comparison import compare
from worker.store import Finding, Trace
from worker.trace import trace

SHARE_OF_MARGIN = 0.1


def run(context: Context, position: int) -> tuple[dict[str, Any], list[Finding], list[Trace]]:
    """Tell the worst cases of all stages apart, then validate the nominal case and each of them."""
    cases = [_case(context, "nominal", context.problem.nominal_point)]
    found = findings.Found()
    driven = drive(context, position, findings.search(context, position, found), _budget(context), repeats=True)
    told = [_finding(context, i, found) for i in range(len(found.basins))]
    order = sorted(range(len(told)), key=lambda i: told[i].cost)
    beyond = {f"F{label}": found.after[i] for label, i in enumerate(order, 1) if i < len(found.after)}
    told = [_labelled(told[i], f"F{label}") for label, i in enumerate(order, 1)]
    cases += [f.validation for f in told]
    traces = [trace(context.problem, f.label, f.parameters) for f in told]
    return _result(context, cases) | _told(context, driven, found, told) | {"after": beyond}, told, traces


def _labelled(finding: Finding, label: str) -> Finding:
    return replace(finding, label=label, validation=finding.validation | {"name": label})


def _budget(context: Context) -> int:
    """At most: telling the worst cases apart, and of all that are kept the neighbours, slices and the boundary."""
    stages = context.campaign.stages
    each = stages.validate_.neighbours + boundary.most(context.problem.dimension)
    return stages.findings.evaluations + stages.findings.at_most * each


def _told(context: Context, driven: Driven, found: findings.Found, told: list[Finding]) -> dict[str, Any]:
    asked = context.campaign.stages.findings
    rules = {"distance": asked.distance, "barrier": asked.barrier, "at_most": asked.at_most}
    complete = driven.stop == "rule"
    text = driven.text if complete else f"{driven.text}: some findings may be one, or not polished to the end"
    gathered = {"candidates": len(found.candidates), "left_out": found.left_out, "complete": complete, "text": text}
    return {"findings": rules | gathered, "comparison": compare(context, told)}


def _case(context: Context, name: str, point: Floats) -> dict[str, Any]:
    problem, tolerance = context.problem, context.campaign.stages.validate_.tolerance
    vector = problem.vectors(point[None, :])
    cost = _cost(context, vector, problem.step)
    half = _cost(context, vector, problem.step / 2)
    # A flight that failed may be beyond any explicit integrator: it would be flown for hours and confirm nothing.
    other = Reference(problem).fly(vector[0]) if cost is not None else Flight(None, "the flight failed")
    allowed = None
    if cost is not None:
        allowed = min(tolerance * abs(cost), SHARE_OF_MARGIN * abs(cost - problem.threshold))
    differences = [_difference(cost, half), _difference(cost, other.cost)]
    return {
        "name": name,
        "step": problem.step,
        "cost": cost,
        "half_step": {"step": problem.step / 2, "cost": half, "difference": differences[0]},
        "integrator": {
            "name": NAME, "cost": other.cost, "difference": differences[1], "reason": other.reason,
        },
        "allowed": allowed,
        "ok": allowed is not None and all(d is not None and abs(d) <= allowed for d in differences),
        "neighbours": None,
    }  # fmt: skip


def _cost(context: Context, vector: Floats, step: float) -> float | None:
    batch, _ = context.problem.fly_vectors(vector, step)
    return float(batch.costs[0, 0]) if batch.status[0] == OK else None


def _difference(cost: float | None, other: float | None) -> float | None:
    return None if cost is None or other is None else other - cost


def _finding(context: Context, i: int, found: findings.Found) -> Finding:
    """The worst case in basin `i`, validated; its label is given once all are sorted."""
    problem, basin = context.problem, found.basins[i]
    neighbours = found.neighbours[i] if i < len(found.neighbours) else None
    case = _case(context, "", basin.point) | {"neighbours": neighbours}
    known = [
        {"position": at, "method": str(context.results[at]["method"]), "evaluations": needed}
        for at, columns in all_columns(context, sorted(context.results))
        if "method" in context.results[at] and (needed := findings.reached(context, columns, basin)) is not None
    ]
    return Finding(
        label="",
        cost=basin.cost,
        margin=basin.cost - problem.threshold,
        parameters=problem.named(basin.point),
        point=[float(u) for u in basin.point],
        methods=list(dict.fromkeys(str(k["method"]) for k in known)),
        found=known,
        at_bounds=problem.at_bounds(basin.point),
        validation=case,
    )


def _result(context: Context, cases: list[dict[str, Any]]) -> dict[str, Any]:
    wrong = [c["name"] for c in cases if not c["ok"]]
    tolerance = context.campaign.stages.validate_.tolerance
    if wrong:
        text = f"half the step or {NAME} disagrees beyond tolerance for {' and '.join(wrong)}"
    else:
        text = f"half the step and {NAME} agree for {' and '.join(str(c['name']) for c in cases)}"
    return {"ok": not wrong, "text": text, "tolerance": tolerance, "cases": cases}
