"""Validate: simulate every distinct worst case again by other means before anything is claimed of it.

First `worker.stages.parts.findings` distinguishes the worst cases, polishes them and evaluates their neighbours; then
each is confirmed at half the step and with the reference integrator (`confirm`), as are the violations that any stage
has stored and a random choice of all evaluations (`offered`). Last comes what shows that the encounter took place
(`encounter`). Start reading at `run`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from campaigns.wording import listed
from worker.reference import NAME
from worker.search.base import OK
from worker.stages.parts import boundary, findings, offered, seeds
from worker.stages.parts.base import Context, Driven, all_columns, drive
from worker.stages.parts.comparison import compare
from worker.stages.parts.confirm import Case, cases
from worker.stages.parts.encounter import encounter
from worker.stages.parts.store import Finding, Trace
from worker.systems.closed_loop.trace import trace


def run(context: Context, position: int) -> tuple[dict[str, Any], list[Finding], list[Trace]]:
    """Distinguish the worst cases of all stages, then validate the nominal case and each of them."""
    found = findings.Found()
    driven = drive(context, position, findings.search(context, position, found), _budget(context), repeats=True)
    unfinished = findings.settle(context, position, found)
    asked = [Case("nominal", context.problem.nominal_point), *(Case("", b.point) for b in found.basins)]
    nominal, *confirmed = cases(context, asked)
    told = [_finding(context, i, found, case) for i, case in enumerate(confirmed)]
    everything = range(position + 1)
    violations, also = offered.violations(context, everything)
    more = _unrepresented(context, told, also, everything)
    order = sorted([*told, *more], key=lambda f: f.cost)
    named = [_labelled(f, f"F{number}") for number, f in enumerate(order, 1)]
    labels = {id(f): n.label for f, n in zip(order, named, strict=True)}
    basins = [labels[id(f)] for f in told]
    traces = [trace(context.problem.under(f.validation["realisation"]), f.label, f.parameters) for f in named]
    beyond = {label: found.of(basin).after for label, basin in zip(basins, found.basins, strict=True)}
    result = _result(context, [nominal, *(f.validation for f in named)])
    result |= {"findings": _gathered(context, driven, found, unfinished)}
    result |= {"comparison": compare(context, named, found, basins), "after": beyond, "violations": violations}
    result |= {"spot_checks": offered.spot_checks(context, everything)}
    flights = [trace(context.problem, "nominal", {}), *traces]
    result |= {"encounter": encounter(context, position, flights, _curves(context, beyond))}
    return result, named, traces


def _labelled(finding: Finding, label: str) -> Finding:
    return replace(finding, label=label, validation=finding.validation | {"name": label})


def _budget(context: Context) -> int:
    """At most: distinguishing the worst cases, and of all that are kept, and of as many that turn up on the way, the
    neighbours, slices and the boundary."""
    stages = context.campaign.stages
    each = stages.validate_.neighbours + boundary.most(context.problem.dimension)
    return stages.findings.evaluations + 2 * stages.findings.at_most * each


def _gathered(context: Context, driven: Driven, found: findings.Found, unfinished: bool) -> dict[str, Any]:
    asked = context.campaign.stages.findings
    complete = driven.stop == "rule" and not unfinished
    text = driven.text if complete else f"{driven.text}: some findings may be one, or not polished to the end"
    return {
        "distance": asked.distance,
        "barrier": asked.barrier,
        "at_most": asked.at_most,
        "candidates": len(found.candidates),
        "left_out": found.left_out,
        "rounds": found.rounds,
        "complete": complete,
        "text": text,
    }


def _finding(context: Context, i: int, found: findings.Found, case: dict[str, Any]) -> Finding:
    """The worst case in basin `i`, validated; its label is given once all are sorted."""
    problem, basin = context.problem, found.basins[i]
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
        validation=case | {"neighbours": found.of(basin).neighbours},
    )


def _unrepresented(
    context: Context, told: Sequence[Finding], also: Sequence[tuple[offered.Stored, dict[str, Any]]], positions: range
) -> list[Finding]:
    """Findings beside the polished ones: the worst confirmed violation where none of them is confirmed, and the lowest
    evaluation that drew its own noise where it is lower than all of them."""
    found = []
    if also and not any(f.validation["violates"] for f in told):
        found.append(_stored(context, *also[0]))
    low = _lowest_drawn(context, positions)
    if low is not None and low.cost < min([f.cost for f in (*told, *found)], default=np.inf):
        found.append(_stored(context, low, *cases(context, [low.case])))
    return found


def _lowest_drawn(context: Context, positions: range) -> offered.Stored | None:
    found = []
    for at, columns, own in seeds.drawn(context, positions):
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        row = int(np.argmin(ranked))
        if np.isfinite(ranked[row]):
            found.append(offered.Stored(at, row, columns.points[row].copy(), float(ranked[row]), int(own[row])))
    return min(found, key=lambda s: s.cost, default=None)


def _stored(context: Context, at: offered.Stored, case: dict[str, Any]) -> Finding:
    """A stored evaluation as a finding, exactly as it was evaluated."""
    problem, method = context.problem, context.results.get(at.position, {}).get("method")
    return Finding(
        label="",
        cost=at.cost,
        margin=at.cost - problem.threshold,
        parameters=problem.named(at.point),
        point=[float(u) for u in at.point],
        methods=[] if method is None else [str(method)],
        found=[] if method is None else [{"position": at.position, "method": method, "evaluations": at.index + 1}],
        at_bounds=problem.at_bounds(at.point),
        validation=case,
    )


def _curves(context: Context, beyond: Mapping[str, Any]) -> list[dict[str, Any]]:
    """All slices: through the nominal point, where sensitivity was asked for, and through the findings."""
    found = [curve for result in context.results.values() for curve in result.get("curves", [])]
    return found + [curve for told in beyond.values() if told for curve in told["slices"]["curves"]]


def _result(context: Context, cases: list[dict[str, Any]]) -> dict[str, Any]:
    wrong = [c["name"] for c in cases if not c["ok"]]
    tolerance = context.campaign.stages.validate_.tolerance
    apart = [c["name"] for c in cases if c["violates"] and not c["agrees"]]
    agreed = [c["name"] for c in cases if c["agrees"]]
    said = []
    if wrong:
        said.append(f"half the step or {NAME} disagrees beyond tolerance for {listed(wrong)}")
    elif agreed:
        said.append(f"half the step and {NAME} agree for {listed(agreed)}")
    if apart:
        said.append(f"all integrations of {listed(apart)} violate, beyond tolerance apart")
    text = "; ".join(said)
    return {"ok": not wrong, "text": text, "tolerance": tolerance, "cases": cases}
