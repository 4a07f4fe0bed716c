"""Validate: simulate every distinct worst case again by independent means before anything is claimed about it.

First `worker.engine.stages.parts.findings` distinguishes the worst cases, polishes them and evaluates their neighbours;
then each is confirmed at half the step and with the reference integrator (`confirm`), as are the violations that any
stage has stored and a random choice of all evaluations (`offered`). The evidence that the encounter took place comes
last (`encounter`). What all this shows is worded by `worker.evidence.verdicts.validation`. Start reading at `run`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from campaigns.asked.allowance import validation
from campaigns.claims.stages import ends
from campaigns.results import Finding, ValidateResult
from campaigns.results.base import OK
from campaigns.results.finding import ClosestApproach, FoundBy, Validation
from campaigns.results.slices import Curve
from campaigns.results.stage import Reevaluated
from campaigns.results.validate import CaseBasin, Downhill, Gathered
from campaigns.stored.records import Trace
from worker.engine.stages.parts import between, findings, incumbents, modes, noise, offered, passing, seeds
from worker.engine.stages.parts.base import all_columns, drive, traced
from worker.engine.stages.parts.comparison import compare, reached
from worker.engine.stages.parts.confirm import cases
from worker.engine.stages.parts.context import Context, Driven
from worker.engine.stages.parts.encounter import encounter
from worker.engine.stages.parts.falls import Fall, not_compared
from worker.engine.stages.parts.left import Left
from worker.engine.stages.parts.outcome import Outcome, Stage
from worker.engine.stages.parts.rays import Evaluated, stored
from worker.engine.stages.parts.repeated import Case
from worker.engine.systems.base import Floats


def run(context: Context, position: int) -> Outcome[ValidateResult]:
    """Distinguish the worst cases of all stages, then validate the nominal case and each of them."""
    found = findings.Found()
    noisy = noise.noisy(context)
    budget = validation(context.campaign, noisy).stored
    driven = drive(context, position, findings.search(context, position, found), budget, repeats=True)
    left = Left(context.campaign, noisy, driven.tally.evaluations)
    unfinished = findings.settle(context, position, found, left)
    first = Case("nominal", context.problem.nominal_point, context.nominal_cost)
    nominal, *confirmed = cases(context, [first, *(Case("", b.point, b.cost) for b in found.basins)])
    everything = range(position + 1)
    evaluated = stored(context, everything)
    polished = [_finding(context, i, found, case, evaluated) for i, case in enumerate(confirmed)]
    passes = passing.confirmed(context, left)
    violations, also = offered.violations(context, everything, left)
    best = incumbents.called(context, polished)
    others = also
    if noisy:
        called = [*incumbents.violating(context, nominal, best), *passing.violating(passes)]
        others = [*sorted(called, key=lambda pair: pair[0].cost), *incumbents.confirmed(context, also, left)]
    order = sorted([*polished, *_unrepresented(context, polished, others, everything)], key=lambda f: f.cost)
    labels = {id(f): f"F{number}" for number, f in enumerate(order, 1)}
    basins = [labels[id(f)] for f in polished]
    shown = [_labelled(f, labels[id(f)]) for f in order]
    flies = context.campaign.scenario is not None
    flights, untraced = _flights(context, shown)
    named = tuple(_closest(f, t if flies else None) for f, t in zip(shown, flights, strict=True))
    nominal_flight = context.problem.system.trace("nominal", {}) if flies else None
    tolerance = context.campaign.stages.validate_.tolerance
    validated = [nominal, *(f.validation for f in named if f.validation is not None), *(v for _, v in passes.values())]
    since = [_matching(context, case, named, found, basins) for case in _reevaluated(context)]
    result = ValidateResult(
        ok=all(case.ok for case in validated),
        statement=(),
        tolerance=tolerance,
        nominal=nominal,
        findings=_gathered(context, driven, found, unfinished),
        comparison=compare(context, named, found, basins),
        violations=violations,
        spot_checks=offered.spot_checks(context, everything, left),
        encounter=encounter(context, position, nominal_flight, named, _curves(context, named)),
        incumbents=best,
        untraced=untraced,
        spent=left.spent(),
        since=since,
        basins=_basins(context, position, found, since, basins, passes),
        modes=modes.named(context, found.lines, named),
    )
    return Outcome(result, named, tuple(t for t in flights if t is not None))


def _reevaluated(context: Context) -> list[Reevaluated]:
    return [case for result in context.results.values() for case in result.reevaluated]


def _matching(
    context: Context, case: Reevaluated, named: Sequence[Finding], found: findings.Found, labels: Sequence[str]
) -> str | None:
    """The finding whose basin contains a case of the baseline: the stored evaluation itself, one with the same noise at
    the same place, or that of the basin that its descent ended in, unless the line to it decides and is not evaluated;
    labels: those of the listed basins."""
    if case.cost is None:
        return None
    point, distance = np.array(case.point), between.near(context)
    for finding in named:
        same = case.realisation == finding.realisation
        apart = float(np.abs(np.array(finding.point) - point).max())
        if same and (apart == 0.0 or (case.realisation is not None and apart < distance)):
            return finding.label
    basin = found.basin_at(point)
    if basin is None or basin >= len(labels) or _undecided(context, case, found, basin):
        return None
    return labels[basin]


def _undecided(context: Context, case: Reevaluated, found: findings.Found, basin: int) -> bool:
    """Whether the allowance did not suffice for the line that decides if a case and a listed worst case are one."""
    end = found.basins[basin]
    return between.decides(context, case, end) and between.line(context, found.since, case, end) is None


def _basins(
    context: Context, position: int, found: findings.Found, since: Sequence[str | None], labels: Sequence[str],
    passes: passing.Passing,
) -> list[CaseBasin]:  # fmt: skip
    """What is known of the basin of each case of the baseline, listed or not; since: their findings, labels: those of
    the listed basins, passes: the cases that violate no more."""
    every, basins = [*found.basins, *found.besides], []
    for k, (case, finding) in enumerate(zip(_reevaluated(context), since, strict=True)):
        basin = found.basin_at(np.array(case.point)) if case.cost is not None and found.descended else None
        listed, line = basin is not None and basin < len(found.basins), None
        if basin is not None and listed and between.decides(context, case, found.basins[basin]):
            line = between.line(context, found.since, case, found.basins[basin]) if finding == labels[basin] else None
            basin = basin if finding is not None else None
        fall = found.falls.cases.get(k)
        basins.append(
            CaseBasin(
                lowest=None if basin is None else every[basin].cost,
                parameters=None if basin is None or listed else context.problem.named(every[basin].point),
                line=line,
                confirmed=passes[k][1] if k in passes else None,
                violation=None if fall is None else _downhill(context, position, fall),
                not_compared=not_compared(context, position, found.falls, k),
            )
        )
    return basins


def _downhill(context: Context, position: int, fall: Fall) -> Downhill | None:
    if fall.violation is None:
        return None
    for at, columns in all_columns(context, [*range(position + 1)]):
        violates = (columns.status == OK) & (columns.costs[:, 0] <= context.problem.threshold)
        rows = np.flatnonzero(violates & (columns.points == fall.violation).all(axis=1))
        if len(rows):
            return Downhill(position=at, index=int(rows[0]), cost=float(columns.costs[rows[0], 0]))
    raise AssertionError(fall.violation)


def _flights(context: Context, shown: Sequence[Finding]) -> tuple[list[Trace | None], dict[str, str]]:
    """The trace of each finding, and by its label why a simulator gave none."""
    system = context.problem.system
    if context.campaign.scenario is not None:
        return [system.trace(f.label, f.parameters, f.realisation) for f in shown], {}
    exact = not noise.noisy(context)
    found = [traced(system, f.label, f.parameters, f.cost, exact) for f in shown]
    return [trace for trace, _ in found], {f.label: why for f, (_, why) in zip(shown, found, strict=True) if why}


def _closest(finding: Finding, flight: Trace | None) -> Finding:
    if flight is None:
        return finding
    return finding.model_copy(update={"closest": ClosestApproach.of(flight.meta.approach, len(flight.data))})


def _labelled(finding: Finding, label: str) -> Finding:
    assert finding.validation is not None
    return finding.model_copy(
        update={"label": label, "validation": finding.validation.model_copy(update={"name": label})}
    )


def _gathered(context: Context, driven: Driven, found: findings.Found, unfinished: bool) -> Gathered:
    request = context.campaign.stages.findings
    complete = driven.stop == "rule" and not unfinished and not found.skipped
    ended = driven.how.statement
    if found.unconfirmed:
        ended = ends.confirmed(len(found.basins), validation(context.campaign, noise.noisy(context)).total)
    elif found.skipped:
        ended = ends.skipped(found.skipped, validation(context.campaign, noise.noisy(context)).total)
    elif not complete:
        ended = ends.by_validation(ended)
    return Gathered(
        distance=between.distance(context),
        barrier=request.barrier,
        at_most=request.at_most,
        candidates=len(found.candidates),
        left_out=found.left_out,
        rounds=found.rounds,
        complete=complete,
        statement=ends.gathered(ended, complete),
    )


def _finding(
    context: Context, i: int, found: findings.Found, case: Validation, everything: Sequence[Evaluated]
) -> Finding:
    """The worst case in basin `i`, validated; it gets its label when all are sorted; everything: that is stored."""
    basin, searched = found.basins[i], context.searched
    evidence = found.of(basin)
    known = [
        FoundBy(position=at, method=searched[at].method, evaluations=needed)
        for at, columns in all_columns(context, list(searched))
        if (needed := reached(context, found, at, columns, i)) is not None
    ]
    slices, located = evidence.after or (None, None)
    beyond = None if located is None else located.described(context.problem, everything)
    found_here = _described(context, basin.point, basin.cost, known, case)
    validation = case.model_copy(update={"neighbours": evidence.neighbours})
    return found_here.model_copy(update={"validation": validation, "slices": slices, "boundary": beyond})


def _described(context: Context, point: Floats, cost: float, found: list[FoundBy], case: Validation) -> Finding:
    problem = context.problem
    return Finding(
        label="",
        cost=cost,
        margin=cost - problem.threshold,
        parameters=problem.named(point),
        point=[float(u) for u in point],
        methods=list(dict.fromkeys(by.method for by in found)),
        found=found,
        at_bounds=problem.at_bounds(point),
        validation=case,
    )


def _unrepresented(
    context: Context, polished: Sequence[Finding], also: Sequence[tuple[offered.Stored, Validation]], positions: range
) -> list[Finding]:
    """Findings besides the polished ones: the worst confirmed violation if none of them is confirmed, and the lowest
    evaluation with its own noise if it is lower than all of them."""
    found = []
    if also and not any(f.validation is not None and f.validation.violates for f in polished):
        found.append(_stored(context, *also[0]))
    low = _lowest_drawn(context, positions)
    if low is not None and low.cost < min([f.cost for f in (*polished, *found)], default=np.inf):
        found.append(_stored(context, low, *cases(context, [low.case])))
    return found


def _lowest_drawn(context: Context, positions: range) -> offered.Stored | None:
    found = []
    for at, columns, own in seeds.drawn(context, positions):
        ranked = columns.ranked()
        row = int(np.argmin(ranked))
        if np.isfinite(ranked[row]):
            found.append(offered.Stored(at, row, columns.points[row].copy(), float(ranked[row]), int(own[row])))
    return min(found, key=lambda s: s.cost, default=None)


def _stored(context: Context, at: offered.Stored, case: Validation) -> Finding:
    """A stored evaluation as a finding, exactly as it was evaluated."""
    search = context.searched.get(at.position)
    found = [] if search is None else [FoundBy(position=at.position, method=search.method, evaluations=at.index + 1)]
    return _described(context, at.point, at.cost, found, case)


def _curves(context: Context, named: Sequence[Finding]) -> Iterator[Curve]:
    """All slices: through the nominal point, if sensitivity was requested, and through the findings."""
    for result in context.results.values():
        yield from result.slices
    for finding in named:
        if finding.slices is not None:
            yield from finding.slices.curves


stage = Stage("validate", run)
