"""The sentences of the validate stage, on what it has confirmed; the stage itself only evaluates: `worded`."""

from __future__ import annotations

from collections.abc import Sequence

from campaigns.claims.say import Part, amount, case, count, joined, listed, number, say, unnamed
from campaigns.claims.spans import Spans
from campaigns.claims.terms import Words
from campaigns.results import StageResult, ValidateResult
from campaigns.results.finding import Finding, Validation
from campaigns.results.validate import Spent, SpotChecks, Violations
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms


def worded(problem: Problem, result: StageResult, findings: Sequence[Finding]) -> StageResult:
    """The result of a stage with the sentences; that of any other stage has its own already."""
    if not isinstance(result, ValidateResult):
        return result
    words = terms(problem.system).words
    cases = [found for found in (result.nominal, *(f.validation for f in findings)) if found is not None]
    cases += result.passing
    statement = _agreement(words, cases) if all(found.repeats is None for found in cases) else _repeated(words, cases)
    counts, spot = result.violations, result.spot_checks
    compared = () if spot is None else say(_compared(words, spot, problem.unit), _left_out(result.spent))
    return result.model_copy(
        update={
            "statement": statement,
            "violations": counts and counts.model_copy(update={"statement": _counts(words, counts, result.spent)}),
            "spot_checks": spot and spot.model_copy(update={"statement": compared}),
        }
    )


def _agreement(words: Words, cases: Sequence[Validation]) -> Spans:
    """Whether all cases are validated: what has no value does not disagree."""
    lacking = [case(c.name) for c in cases if not c.ok and c.incomplete]
    wrong = [case(c.name) for c in cases if not c.ok and not c.incomplete]
    apart = [case(c.name) for c in cases if c.violates and not c.agrees]
    agreed = [case(c.name) for c in cases if c.agrees]
    statement: list[Part] = []
    if wrong:
        statement.append(say(f"{words.disagrees} by more than the tolerance for ", listed(wrong)))
    if lacking:
        verb = "lacks a value" if len(lacking) == 1 else "lack a value"
        statement.append(say(listed(lacking), f" {verb} when {words.again}", _refused(cases)))
    elif agreed and not wrong:
        statement.append(say(f"{words.agree} for ", listed(agreed)))
    if apart:
        statement.append(say(f"{words.every} of ", listed(apart), " violate, but differ by more than the tolerance"))
    return joined("; ", statement)


def _refused(cases: Sequence[Validation]) -> str:
    """Why a simulator gave no value at half the step, in parentheses: what it says of the first of these cases."""
    found = (c.half_step.reason for c in cases if not c.ok and c.half_step is not None and c.half_step.cost is None)
    why = next(filter(None, found), "")
    return why and f" (at half the step: {why})"


def _repeated(words: Words, cases: Sequence[Validation]) -> Spans:
    """What the independent calls of a simulator that does not repeat show."""
    parts = [say(case(v.name), " ", v.repeats.statement) for v in cases if v.repeats is not None]
    of = say(f"in independent calls, each {words.reference}, ", joined(", ", parts))
    unknown = [case(v.name) for v in cases if not v.ok]
    but = say("; not confirmed for ", listed(unknown)) if unknown else ()
    return unnamed(say(of, but))


def _counts(words: Words, found: Violations, spent: Spent | None) -> Spans:
    if found.stored == 0:
        return say("no stored evaluation violates the criterion")
    verb = "evaluation violates" if found.stored == 1 else "evaluations violate"
    many = say(count(found.stored, "violating"), f" stored {verb} the criterion; ")
    if not found.checked:
        none = say(many, "validation examined none of them")
        most = None if spent is None else count(spent.at_most, "at_most")
        return none if most is None else say(none, ", because it is limited to ", most, " evaluations")
    of = say("it" if found.stored == 1 else "all of them")
    if found.checked < found.stored:
        of = say(count(found.checked, "checked"), " of them, spread over the range of values,")
    confirmed = count(found.confirmed, "confirmed")
    were = "was" if found.checked == 1 else "were"
    violate = "violates" if found.confirmed == 1 else "violate"
    return say(many, of, f" {were} {words.again}, and ", confirmed, f" {violate} there as well")


def _left_out(spent: Spent | None) -> Spans:
    """The random evaluations that the allowance of validation did not suffice for."""
    if spent is None or not spent.left_out.spot_checks:
        return ()
    lost = say("; ", count(spent.left_out.spot_checks, "left_out"), " more were not compared, because validation is")
    return say(lost, " limited to ", count(spent.at_most, "at_most"), " evaluations")


def _compared(words: Words, found: SpotChecks, unit: str) -> Spans:
    by = words.reference
    why = f" ({found.reasons[0]})" if found.reasons else ""
    if found.largest is None or found.median is None:
        return say(f"no random evaluation could be compared with {by}{why}")
    differ = "differs" if found.compared == 1 else "differ"
    statement = say(
        *(amount(found.compared, "random evaluation", "compared"), f" {differ} from {by} by at most "),
        *(number(found.largest, unit, "largest"), ", half of them by at most ", number(found.median, unit, "median")),
    )
    without = found.checked - found.compared
    if without:
        statement = say(statement, "; ", count(without), f" more could not be compared{why}")
    if found.violating:
        violate = "violates" if found.violating == 1 else "violate"
        statement = say(statement, "; ", count(found.violating), f" {violate} the criterion only with {by}")
    return statement
