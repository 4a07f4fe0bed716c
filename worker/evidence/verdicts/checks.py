"""The checks of a verdict: everything that must hold before a campaign is cleared, each with its sentence."""

from __future__ import annotations

from collections.abc import Iterator

from campaigns import rules
from campaigns.checked.distances import mismeasured
from campaigns.claims.say import Part, count, finding, joined, method, number, on_side, say, signed, unnamed
from campaigns.claims.spans import Spans
from campaigns.codes import CheckCode
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.agreement import agreement
from worker.evidence.verdicts.calls import calls
from worker.evidence.verdicts.encounter import encounter
from worker.evidence.verdicts.evidence import Evidence, check
from worker.evidence.verdicts.probability import probability

ROUNDED = 1e-9
"""Fraction of the grid within which a margin is a whole step of it."""


def checks(problem: Problem, evidence: Evidence) -> list[Check]:
    """All checks in the order of the rules."""
    found = [
        _nominal(problem, evidence),
        _ended(evidence),
        _no_violation(problem, evidence),
        _minimum(problem, evidence),
        agreement(problem, evidence),
        _validated(problem, evidence),
        *_resolution(problem, evidence),
        _none_failed(evidence),
        *calls(problem, evidence),
        *encounter(problem, evidence),
        *(check(code, False, statement) for code, statement in _bars(problem, evidence).items()),
        *probability(problem, evidence),
    ]
    return sorted(found, key=lambda check: rules.position(check.code))


def _bars(problem: Problem, evidence: Evidence) -> dict[str, Spans]:
    """What rules out "cleared" for any result, and a criterion that does not compute the distance that it declares."""
    own, found = terms(problem.system), evidence.encounter.mismeasured
    wrong: dict[str, Spans] = {}
    if found is not None:
        wrong[CheckCode.DISTANCES] = mismeasured(own.declares, found, problem.unit)
    return wrong | dict(own.bars)


def _nominal(problem: Problem, evidence: Evidence) -> Check:
    nominal, unit = evidence.nominal, problem.unit
    if nominal.status != "ok" or nominal.cost is None or nominal.margin is None:
        return check(CheckCode.NOMINAL, False, f"the nominal case has no value: {nominal.reason}")
    cost = on_side(nominal.cost, problem.threshold, unit, "cost")
    margin = signed(nominal.margin, unit, "margin")
    return check(CheckCode.NOMINAL, nominal.margin > 0, "the nominal case has ", cost, ", a margin of ", margin)


def _ended(evidence: Evidence) -> Check:
    empty = [method(s.method, s.title) for s in evidence.searches if s.best is None]
    if empty:
        return check(CheckCode.SEARCH, False, joined(" and ", empty), " evaluated no case successfully")
    stopped = [(s, s.stop) for s in evidence.searches if s.stop is not None]
    ways = joined(", ", [say(method(s.method, s.title), " ", unnamed(stop.statement)) for s, stop in stopped])
    every = len(stopped) == len(evidence.searches)
    return check(CheckCode.SEARCH, every, "every search ended: " if every else "not every search ended: ", ways)


def _no_violation(problem: Problem, evidence: Evidence) -> Check:
    """Over every stored evaluation of any stage."""
    worst, unit, code = evidence.finding, problem.unit, CheckCode.NO_VIOLATION
    if worst is None:
        return check(code, False, "no evaluation succeeded")
    violation = evidence.violation
    if worst.cost > problem.threshold and violation is not None and violation.validation is not None:
        # Of a simulator that does not repeat: no stored evaluation violates, but an independent call does.
        repeats = violation.validation.repeats
        called = () if repeats is None else say(" ", repeats.statement)
        counts = evidence.violations.statement
        return check(code, False, "in independent calls ", finding(violation.label), called, "; ", counts)
    if worst.cost > problem.threshold and not evidence.violating:
        return check(code, True, "the worst case found has a margin of ", signed(worst.margin, unit, "margin"))
    counts = evidence.violations.statement
    if worst.cost > problem.threshold:
        return check(code, False, counts)
    stated = violation or worst
    confirmed = "confirmed" if violation is not None else "did not confirm"
    if violation is None and worst.violates:
        confirmed = "contradicts itself on"
    by = number(problem.threshold - stated.granted, unit, "violated_by")
    violates = (finding(stated.label), " violates the criterion by ", by)
    return check(code, False, *violates, f"; validation {confirmed} it; ", counts)


def _minimum(problem: Problem, evidence: Evidence) -> Check:
    """No stored evaluation is lower than the worst finding, and it was fully polished."""
    worst, unit, code = evidence.finding, problem.unit, CheckCode.MINIMUM
    if worst is None or evidence.lowest is None:
        return check(code, False, "no evaluation succeeded")
    if evidence.lowest < worst.cost:
        lowest = on_side(evidence.lowest, problem.threshold, unit, "lowest")
        return check(code, False, "a stored evaluation has ", lowest, ", lower than every finding")
    gathered = evidence.gathered
    if not gathered.complete:
        return check(code, False, gathered.statement)
    succeeded = count(evidence.succeeded, "evaluations")
    return check(code, True, finding(worst.label), " is the lowest of all ", succeeded, " evaluations of all stages")


def _validated(problem: Problem, evidence: Evidence) -> Check:
    """Nominal case and findings are within tolerance, and every random evaluation is on the same side of the
    threshold."""
    validation, spot = evidence.validation, evidence.spot_checks
    ok = validation.ok and not spot.violating and spot.compared == spot.checked
    ok = ok and not (validation.spent and validation.spent.left_out.spot_checks)
    return check(CheckCode(terms(problem.system).words.check), ok, validation.statement, "; ", spot.statement)


def _resolution(problem: Problem, evidence: Evidence) -> Iterator[Check]:
    """That the margin is less than the step of the lowest values; nothing otherwise."""
    spread, unit = evidence.encounter.spread, problem.unit
    if spread.lowest is None or not 0 < spread.lowest - problem.threshold < spread.grid * (1 - ROUNDED):
        return
    margin = signed(spread.lowest - problem.threshold, unit, "margin")
    differ = say(
        "the lowest values differ in steps of ", number(spread.grid, unit, "grid"), ", and the margin is ", margin
    )
    why = "a rounded value may hide a violation; let the criterion return it unrounded"
    yield check(CheckCode.RESOLUTION, False, differ, ": ", why)


def _none_failed(evidence: Evidence) -> Check:
    failed: Part = count(evidence.failed, "failed") if evidence.failed else "none"
    excluded = say(", ", count(evidence.excluded, "excluded"), " excluded") if evidence.excluded else ()
    of = (failed, " of ", count(evidence.evaluations, "evaluations"), " evaluations failed", excluded)
    return check(CheckCode.EVALUATIONS, not evidence.failed, *of)
