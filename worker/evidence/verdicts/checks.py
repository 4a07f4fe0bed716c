"""The checks of a verdict: everything that must hold before a campaign is cleared, each with its sentence."""

from __future__ import annotations

from campaigns import rules
from campaigns.claims.say import Part, count, finding, joined, method, number, say, signed, unnamed
from campaigns.codes import CheckCode
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.agreement import agreement
from worker.evidence.verdicts.calls import calls
from worker.evidence.verdicts.encounter import encounter
from worker.evidence.verdicts.evidence import Evidence
from worker.evidence.verdicts.probability import probability


def checks(problem: Problem, evidence: Evidence) -> list[Check]:
    """All checks in the order of the rules."""
    found = [
        _nominal(problem, evidence),
        _ended(problem, evidence),
        _no_violation(problem, evidence),
        _minimum(problem, evidence),
        agreement(problem, evidence),
        _validated(problem, evidence),
        _none_failed(evidence),
        *calls(problem, evidence),
        *encounter(problem, evidence),
        *_distances(problem),
        *probability(problem, evidence),
    ]
    return sorted(found, key=lambda check: rules.position(check.code))


def _nominal(problem: Problem, evidence: Evidence) -> Check:
    nominal, unit = evidence.nominal, problem.unit
    if nominal.status != "ok" or nominal.cost is None or nominal.margin is None:
        statement = say(f"the nominal case was not evaluated: {nominal.reason}")
        return Check(code=CheckCode.NOMINAL, ok=False, statement=statement)
    cost, margin = number(nominal.cost, unit, "cost"), signed(nominal.margin, unit, "margin")
    statement = say("the nominal case has ", cost, ", a margin of ", margin)
    return Check(code=CheckCode.NOMINAL, ok=nominal.margin > 0, statement=statement)


def _ended(problem: Problem, evidence: Evidence) -> Check:
    empty = [method(s.method, s.title) for s in evidence.searches if s.best is None]
    if empty:
        statement = say(joined(" and ", empty), " evaluated no case successfully")
        return Check(code=CheckCode.SEARCH, ok=False, statement=statement)
    stopped = [(s, s.stop) for s in evidence.searches if s.stop is not None]
    ways = joined(", ", [say(method(s.method, s.title), " ", unnamed(stop.statement)) for s, stop in stopped])
    every = len(stopped) == len(evidence.searches)
    ended = "every search ended: " if every else "not every search ended: "
    return Check(code=CheckCode.SEARCH, ok=every, statement=say(ended, ways))


def _no_violation(problem: Problem, evidence: Evidence) -> Check:
    """Over every stored evaluation of any stage."""
    worst, unit, code = evidence.finding, problem.unit, CheckCode.NO_VIOLATION
    if worst is None:
        return Check(code=code, ok=False, statement=say("no evaluation succeeded"))
    violation = evidence.violation
    if worst.margin > 0 and violation is not None and violation.validation is not None:
        # Of a simulator that does not repeat: no stored evaluation violates, but an independent call does.
        repeats = violation.validation.repeats
        called = () if repeats is None else say(" ", repeats.statement)
        statement = say("in independent calls ", finding(violation.label), called, "; ", evidence.violations.statement)
        return Check(code=code, ok=False, statement=statement)
    if worst.margin > 0 and not evidence.violating:
        statement = say("the worst case found has a margin of ", signed(worst.margin, unit, "margin"))
        return Check(code=code, ok=True, statement=statement)
    counts = evidence.violations.statement
    if worst.margin > 0:
        return Check(code=code, ok=False, statement=counts)
    confirmed = "confirmed" if worst.violates else "did not confirm"
    by = number(-worst.margin, unit, "violated_by")
    statement = say(finding(worst.label), " violates the criterion by ", by, f"; validation {confirmed} it; ", counts)
    return Check(code=code, ok=False, statement=statement)


def _minimum(problem: Problem, evidence: Evidence) -> Check:
    """No stored evaluation is lower than the worst finding, and it was fully polished."""
    worst, unit, code = evidence.finding, problem.unit, CheckCode.MINIMUM
    if worst is None or evidence.lowest is None:
        return Check(code=code, ok=False, statement=say("no evaluation succeeded"))
    if evidence.lowest < worst.cost:
        lowest = number(evidence.lowest, unit, "lowest")
        return Check(
            code=code, ok=False, statement=say("a stored evaluation has ", lowest, ", lower than every finding")
        )
    gathered = evidence.gathered
    if not gathered.complete:
        statement = say("the worst cases were not fully distinguished: ", gathered.statement)
        return Check(code=code, ok=False, statement=statement)
    succeeded = count(evidence.succeeded, "evaluations")
    statement = say(finding(worst.label), " is the lowest of all ", succeeded, " evaluations of all stages")
    return Check(code=code, ok=True, statement=statement)


def _validated(problem: Problem, evidence: Evidence) -> Check:
    """Nominal case and findings are within tolerance, and no random evaluation is on the other side of the
    threshold."""
    validation, spot = evidence.validation, evidence.spot_checks
    ok = validation.ok and not spot.violating and (spot.compared > 0 or not spot.checked)
    return Check(
        code=CheckCode(terms(problem.system).words.check),
        ok=ok,
        statement=say(validation.statement, "; ", spot.statement),
    )


def _distances(problem: Problem) -> list[Check]:
    """Checks that rule out "cleared" for any result, such as that a vehicle inside an obstacle counts as clear."""
    return [Check(code=code, ok=False, statement=statement) for code, statement in terms(problem.system).bars]


def _none_failed(evidence: Evidence) -> Check:
    failed: Part = count(evidence.failed, "failed") if evidence.failed else "none"
    excluded = say(", ", count(evidence.excluded, "excluded"), " excluded") if evidence.excluded else ()
    statement = say(failed, " of ", count(evidence.evaluations, "evaluations"), " evaluations failed", excluded)
    return Check(code=CheckCode.EVALUATIONS, ok=not evidence.failed, statement=statement)
