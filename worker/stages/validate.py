"""Validate: fly the worst case again by other means before anything is claimed of it.

A few hundred neighbours within a thousandth of each range first, keeping the lowest (the objective is not smooth);
then half the step and another integrator. Disagreement beyond tolerance is reported and bars "cleared".
"""

from __future__ import annotations

from typing import Any

import numpy as np

from worker import integrator
from worker.problem import Floats
from worker.search.base import OK, Search
from worker.stages.base import Context, Driven, all_columns, drive
from worker.store import Columns, Finding, Trace
from worker.trace import trace

SHARE_OF_MARGIN = 0.1
SAME_COST, SAME_PLACE = 0.01, 0.05
"""A method found the worst case when it came this close: share of nominal minus worst, share of every range."""


def run(context: Context, position: int) -> tuple[dict[str, Any], list[Finding], list[Trace]]:
    """Validate the nominal case and the worst evaluation of all stages."""
    cases = [_case(context, "nominal", context.problem.nominal_point)]
    worst = worst_so_far(context, position)
    if worst is None:
        return _result(context, cases), [], []
    point, cost = worst
    driven = drive(context, position, _neighbours(context, point), context.campaign.stages.validate_.neighbours)
    lowest = driven.tally
    if lowest.best is not None and lowest.best_point is not None and lowest.best < cost:
        point = lowest.best_point
    case = _case(context, "F1", point) | {"neighbours": _told(driven, cost)}
    finding = _finding(context, position, point, case)
    cases.append(case)
    return _result(context, cases), [finding], [trace(context.problem, "F1", finding.parameters)]


def worst_so_far(context: Context, position: int) -> tuple[Floats, float] | None:
    """The lowest evaluation of all stages before this one: point and cost."""
    found: tuple[Floats, float] | None = None
    for _, columns in all_columns(context, list(range(position))):
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        row = int(np.argmin(ranked))
        if np.isfinite(ranked[row]) and (found is None or ranked[row] < found[1]):
            found = columns.points[row].copy(), float(ranked[row])
    return found


def _neighbours(context: Context, point: Floats) -> Search:
    validate = context.campaign.stages.validate_
    if validate.neighbours == 0:
        return "no neighbours were asked for"
    random = np.random.default_rng(np.random.SeedSequence(context.campaign.seed, spawn_key=(2**20,)))
    offsets = random.uniform(-validate.reach, validate.reach, (validate.neighbours, len(point)))
    yield np.clip(point + offsets, 0.0, 1.0)
    return "flew every neighbour"


def _told(driven: Driven, cost: float) -> dict[str, Any]:
    best = driven.tally.best
    return {
        "flown": driven.tally.evaluations,
        "failed": driven.tally.failed,
        "lowest": best,
        "lower_by": None if best is None else max(0.0, cost - best),
    }


def _case(context: Context, name: str, point: Floats) -> dict[str, Any]:
    problem, tolerance = context.problem, context.campaign.stages.validate_.tolerance
    vector = problem.vectors(point[None, :])
    cost = _cost(context, vector, problem.step)
    half = _cost(context, vector, problem.step / 2)
    # A flight that failed may be beyond any explicit integrator: it would be flown for hours and confirm nothing.
    other = integrator.fly(problem, vector[0]) if cost is not None else integrator.Flight(None, "the flight failed")
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
            "name": integrator.NAME, "cost": other.cost, "difference": differences[1], "reason": other.reason,
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


def _finding(context: Context, position: int, point: Floats, case: dict[str, Any]) -> Finding:
    problem = context.problem
    found = [
        str(context.results[at]["method"])
        for at, columns in all_columns(context, sorted(context.results))
        if "method" in context.results[at] and _reached(context, columns, point, case["cost"])
    ]
    lowered = (case["neighbours"] or {}).get("lower_by") or 0.0
    return Finding(
        label="F1",
        cost=case["cost"],
        margin=case["cost"] - problem.threshold,
        parameters=problem.named(point),
        point=[float(u) for u in point],
        methods=list(dict.fromkeys(found)) + (["neighbours"] if lowered > 0.0 else []),
        at_bounds=problem.at_bounds(point),
        validation=case,
    )


def _reached(context: Context, columns: Columns, point: Floats, cost: float) -> bool:
    """Whether a method's own evaluations came this close to the finding."""
    nominal = context.results[0].get("cost")
    near = SAME_COST * abs((cost if nominal is None else nominal) - cost)
    low = (columns.status == OK) & (columns.costs[:, 0] <= cost + near)
    return bool((np.abs(columns.points[low] - point) <= SAME_PLACE).all(axis=1).any())


def _result(context: Context, cases: list[dict[str, Any]]) -> dict[str, Any]:
    wrong = [c["name"] for c in cases if not c["ok"]]
    tolerance = context.campaign.stages.validate_.tolerance
    if wrong:
        text = f"half the step or {integrator.NAME} disagrees beyond tolerance for {' and '.join(wrong)}"
    else:
        text = f"half the step and {integrator.NAME} agree for {' and '.join(str(c['name']) for c in cases)}"
    return {"ok": not wrong, "text": text, "tolerance": tolerance, "cases": cases}
