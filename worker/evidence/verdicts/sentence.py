"""The sentences of a verdict: what was found, and the scope it holds for."""

from __future__ import annotations

from campaigns.claims.say import (
    Part,
    capital,
    count,
    finding,
    interval,
    joined,
    limit,
    listed,
    method,
    number,
    on_side,
    probability,
    say,
    signed,
    symbol,
    unnamed,
)
from campaigns.claims.spans import Spans
from campaigns.codes import CheckCode
from campaigns.results import Finding
from campaigns.results.finding import Validation
from campaigns.results.verdict import Check, Statistics, VerdictWord
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts import calls, encounter, exclusions
from worker.evidence.verdicts.evidence import Evidence


def sentence(
    problem: Problem, evidence: Evidence, verdict: VerdictWord, checks: list[Check], statistics: Statistics | None
) -> Spans:
    """The verdict as a sentence; all counts are of stored evaluations."""
    found = evidence.finding
    quantity = symbol(problem.quantity)
    threshold = limit(problem.threshold, problem.unit, "threshold")
    if found is None:
        return say(f"No {terms(problem.system).words.one} could be evaluated: ", checks[0].statement, ".")
    stated = evidence.violation or found
    worst = _worst(problem, stated, "found" if stated is found else "confirmed")
    each = calls.each(problem)
    how = say(count(evidence.evaluations, "evaluations"), f" evaluations{each}, searched by ", _searched(evidence))
    lost = _without_value(problem, evidence)
    if evidence.violation is not None:
        chance = say(_chance(statistics), calls.condition(evidence, checks) if statistics else "")
        shown = _shown(problem, found, evidence.violation)
        apart = say(calls.repeated(problem, evidence.violation), _apart(evidence.violation.validation, problem.unit))
        counts = say(" ", capital(evidence.violations.statement), ".")
        rest = say(lost, apart, counts, chance)
        return say(quantity, " falls to or below ", threshold, ". ", worst, " ", shown, " in ", how, ".", rest)
    if verdict == "cleared":
        succeeded = count(evidence.succeeded, "evaluations")
        excluded = _excluded(problem, evidence)
        caveat = terms(problem.system).caveat
        caveat = f" {caveat}" if caveat else ""
        intended = [say(" ", unnamed(s)) for s in (*encounter.stated(problem, checks), *calls.stated(problem, checks))]
        return say(
            *(quantity, " stayed above ", threshold, " in all ", succeeded, f" evaluations{each}", _flights(problem)),
            *(", searched by ", _searched(evidence), ".", excluded, " ", worst, _chance(statistics)),
            encounter.within(problem, evidence) if statistics is not None else "",
            *intended,
            f"{caveat} A search can miss a worse case.",
        )
    why = joined("; ", [_reason(c) for c in checks if not c.ok])
    return say("Nothing may be claimed: ", why, ". ", worst, " It was found in ", how, ".", lost)


def scope(problem: Problem, measured: bool = True) -> Spans:
    """The scope of the sentence: the system with its conditions, bounds and settings. measured: whether the criterion
    computes the distance that it declares."""
    described, paths = terms(problem.system).scope, problem.symbols
    units = {p.path: p.unit for p in problem.system.parameters}
    bounds = [say(paths[r.path], ": ", interval(r.low, r.high, units[r.path])) for r in problem.ranges]
    settings = say("; ", described.settings) if described.settings else ()
    distances = say("; ", described.distances) if described.distances and measured else ()
    ends = f". This result holds for this model within these bounds; {described.version}."
    return say(described.what, "; ", joined("; ", bounds), settings, distances, ends)


def _reason(check: Check) -> Spans:
    """The reason of a check; only the numbers of violations have their names, because they are also the verdict's."""
    return check.statement if check.code == CheckCode.NO_VIOLATION else unnamed(check.statement)


def _worst(problem: Problem, found: Finding, which: str) -> Spans:
    margin = signed(found.granted - problem.threshold, problem.unit, "margin")
    cost = on_side(found.granted, problem.threshold, problem.unit, "worst")
    called = found.validation is not None and found.validation.repeats is not None
    by = "" if found.granted == found.cost else " in an independent call" if called else " in every evaluation of it"
    has = say(f"The worst case {which} has ", symbol(problem.quantity), " = ", cost, by)
    return say(has, ", a margin of ", margin, _noise(found.realisation), ".")


def _shown(problem: Problem, found: Finding, violation: Finding) -> Spans:
    """Which violation was validated."""
    if violation.cost > problem.threshold:
        none = "No stored evaluation violates the criterion, but calls of " if violation is found else "Calls of "
        return say(none, finding(violation.label), " independent of the search do; it was found")
    if violation is found:
        return say("It was confirmed by validation and found")
    cost = on_side(found.cost, problem.threshold, problem.unit, "lowest")
    lower = say(finding(found.label), ", evaluated as ", cost)
    why = "violates by less in its other evaluations" if found.violates else "was not confirmed"
    return say("It is ", finding(violation.label), "; ", lower, _noise(found.realisation), f", {why}; both were found")


def _searched(evidence: Evidence) -> Spans:
    """Every method with the number of its own evaluations."""
    spent: dict[tuple[str, str], int] = {}
    for search in evidence.searches:
        of = (search.method, search.title)
        spent[of] = spent.get(of, 0) + search.evaluations
    return listed([say(method(*of), " (", count(many, f"searched.{of[0]}"), ")") for of, many in spent.items()])


def _flights(problem: Problem) -> Spans:
    """How long every evaluation of a closed loop was simulated, a clause; of what comes later a check tells."""
    scenario = problem.campaign.scenario
    return () if scenario is None else say(", flights of ", limit(scenario.horizon, "s"))


def _chance(statistics: Statistics | None) -> Spans:
    if statistics is None:
        return ()
    quantile = statistics.quantile
    bound = say(" ", capital(unnamed(quantile.statement)), ".") if quantile is not None else ()
    return say(" ", statistics.statement, ".", bound)


def _excluded(problem: Problem, evidence: Evidence) -> Spans:
    """The evaluations beyond those that a cleared verdict rests on; of a simulator with fraction and reasons."""
    if not evidence.excluded:
        return ()
    number, why = count(evidence.excluded, "excluded"), exclusions.reasons(problem, evidence)
    fraction = say(" (", probability(evidence.excluded / evidence.evaluations), ")") if why else ()
    return say(" ", number, " more", fraction, " were excluded", why, ".")


def _without_value(problem: Problem, evidence: Evidence) -> Spans:
    """How many evaluations failed, were excluded or were tried again; empty if there are none."""
    parts: list[Part] = []
    if evidence.failed:
        parts.append(say(count(evidence.failed, "without_value.failed"), " failed"))
    if evidence.excluded:
        verb = " was excluded" if evidence.excluded == 1 else " were excluded"
        why = exclusions.reasons(problem, evidence)
        parts.append(say(count(evidence.excluded, "without_value.excluded"), verb, why))
    if evidence.flaky:
        parts.append(say(count(evidence.flaky, "flaky"), " succeeded only when tried again"))
    return say(" Of these, ", joined(" and ", parts), ".") if parts else ()


def _apart(case: Validation | None, unit: str) -> Spans:
    """The values of a violation that differ beyond tolerance, by whatever confirms it; empty if they agree."""
    if case is None or case.agrees or case.agrees is None:
        return ()
    others = [other for other in (case.half_step, case.integrator, case.again) if other is not None]
    values = (case.cost, *(other.cost for other in others))
    step, *rest = (f"no value {unit}" if value is None else number(value, unit) for value in values)
    if case.again is not None and case.half_step is not None:
        statement = say(" Its evaluations violate the criterion but differ beyond tolerance: ", step, ", ", rest[-1])
        return say(statement, f" in {case.again.name}, ", rest[0], " at half the step.")
    if case.again is not None:
        apart = say(
            " Both its evaluations violate the criterion but differ beyond tolerance: ", step, ", and ", rest[-1]
        )
        return say(apart, f" in {case.again.name}.")
    if case.half_step is None or case.integrator is None:
        return ()
    half, other = rest
    return say(
        *(" All its integrations violate the criterion but differ beyond tolerance: ", step, " at the step, "),
        *(half, " at half the step, ", other, f" with {case.integrator.name}."),
    )


def _noise(seed: int | None) -> str:
    return "" if seed is None else f", with the noise realisation of seed {seed}"


def method_of(finding: Finding, evidence: Evidence) -> str | None:
    """The method that found it: the one with the lowest best if it is among those, else the quickest; None if no search
    did."""
    found = [by.method for by in sorted(finding.found, key=lambda by: by.evaluations)] or finding.methods
    if not found or finding.realisation is not None:
        return None
    bests = [(s.best.cost, i) for i, s in enumerate(evidence.searches) if s.best is not None]
    lowest = evidence.searches[min(bests)[1]].method if bests else None
    return lowest if lowest in found else found[0]
