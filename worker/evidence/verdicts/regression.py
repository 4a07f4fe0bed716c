"""Regression: what has become of every finding of the baseline, and which findings are new.

A finding of the baseline violated there if it is at or below both runs' thresholds: one that a raised threshold makes a
violation violates newly, and one that a lowered threshold makes none is not fixed. It is worse if it costs less on this
model by more than the tolerance, or if the search found a case in its basin that is lower than any finding of the
baseline there: of that one the tolerance is larger, because two searches do not stop at the same point. A case that
begins or ceases to violate has changed whatever the tolerance; it is fixed only if nothing known in its basin violates,
listed as a finding or not, and if the case itself is confirmed as a finding is: evaluated again, at half the step, with
the reference integrator, in independent calls. It is unresolved if validation could not examine the basin, or did not
confirm the case. Of a simulator that does not repeat, a violation is also one that only independent calls show.

A violation of the baseline and a violating finding in its basin are two if a case on the line between them is clear:
one basin has barriers of a fraction of nominal minus worst, which may be far above the threshold.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from campaigns import rules
from campaigns.asked.regression import Baseline, BaselineCase, CallsThere, Policy
from campaigns.claims.say import amount, count, finding, joined, limit, on_side, say, signed, symbol
from campaigns.claims.spans import Spans
from campaigns.codes import CheckCode
from campaigns.results import Finding
from campaigns.results.baselines import difference
from campaigns.results.regression import FindingChange, Regression, Standing
from campaigns.results.stage import Reevaluated
from campaigns.results.validate import CaseBasin
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.verdicts import calls
from worker.evidence.verdicts.evidence import Evidence

IS = {Standing.SAME: "the same"}
"""A standing in the words of a sentence, where it is not the word itself."""
MENDED = (Standing.FIXED, Standing.BETTER)
UNKNOWN = (Standing.NOT_COMPARED, Standing.UNRESOLVED)
CALLED = " in an independent call"
NAMED = 3
"""Findings that the sentence names."""


def regression(problem: Problem, evidence: Evidence, checks: Sequence[Check]) -> Regression | None:
    """Every finding of either run with its change; None without a baseline. The policy accepts known violations only
    where every check holds that they alone do not make fail, and where all violating findings are listed."""
    baseline = problem.campaign.baseline
    evaluated = next((at for at, result in enumerate(evidence.results) if result.reevaluated), None)
    if baseline is None or evaluated is None:
        return None
    policy, matched = problem.campaign.regression, evidence.validation.since
    found = {f.label: f for f in evidence.findings}
    examined: Sequence[CaseBasin | None] = evidence.validation.basins or [None] * len(matched)
    basins = [_Basin(found.get(label or ""), basin) for label, basin in zip(matched, examined, strict=True)]
    again = evidence.results[evaluated].reevaluated
    basins = [_own(problem, evidence, *row) for row in zip(baseline.cases, again, basins, strict=True)]
    rows = list(zip(baseline.cases, again, basins, strict=True))
    same = {basin.finding.label for basin in basins if basin.finding is not None}
    # Of several findings of the baseline in one basin, the lowest one represents it.
    lowest: dict[object, float] = {}
    for case, _, basin in rows:
        lowest[basin.key] = min(case.stated, lowest.get(basin.key, case.stated))
    cases = [_known(problem, evidence, baseline, *row, row[0].stated <= lowest[row[2].key]) for row in rows]
    apart = {basin.apart: case.label for case, _, basin in reversed(rows)}
    cases += [_new(problem, f, baseline.run, apart.get(f.label)) for f in evidence.findings if f.label not in same]
    strictest = max(baseline.threshold, problem.threshold) - problem.threshold
    cases = [case.model_copy(update={"fails": _fails(policy, case, strictest)}) for case in cases]
    cases.sort(key=lambda case: (not case.fails, case.margin is None, case.margin or 0.0))
    failing = [case for case in cases if case.fails]
    violating = [case for case in cases if case.margin is not None and case.margin <= 0]
    # Without a violating finding none was known, because it has not been compared.
    all_known = bool(violating) and not any(case.newly_violating for case in violating)
    known = "violation" not in policy.fail_on and all_known
    beside = _beside(problem, evidence, checks) if known else ()
    return Regression(
        run=baseline.run,
        position=evaluated,
        cases=cases,
        fail_on=policy.fail_on,
        ok=not failing,
        accepted=known and not beside,
        quantity=problem.quantity,
        unit=problem.unit,
        statement=say(_statement(problem, baseline, cases, failing), beside),
    )


@dataclass(frozen=True)
class _Basin:
    """Of a case: the finding in it, and what else is known of it."""

    finding: Finding | None
    known: CaseBasin | None
    """None in results of earlier versions, which know the findings only."""
    apart: str | None = None
    """The finding that is not the same, because a case between them is clear."""

    @property
    def cost(self) -> float:
        """The lowest, or what independent calls show; infinite if not known."""
        if self.finding is not None:
            return min(self.finding.cost, self.finding.granted)
        return math.inf if self.known is None or self.known.lowest is None else self.known.lowest

    @property
    def key(self) -> object:
        """A key that is equal for cases in one basin."""
        return self.finding.label if self.finding is not None else self.cost

    @property
    def called(self) -> bool:
        """Whether only independent calls show its lowest."""
        return self.finding is not None and self.cost < self.finding.cost

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of its lowest cost."""
        own = self.finding.parameters if self.finding is not None else self.known and self.known.parameters
        return own or {}

    def violates(self, threshold: float) -> bool:
        """Whether something known in it does."""
        return self.cost <= threshold or (self.known is not None and self.known.violation is not None)

    @property
    def resolved(self) -> bool:
        """Whether validation has examined it."""
        return self.known is None or (self.known.lowest is not None and not self.known.not_compared)


def _known(
    problem: Problem, evidence: Evidence, baseline: Baseline, before: BaselineCase, again: Reevaluated, basin: _Basin,
    stands: bool,
) -> FindingChange:  # fmt: skip
    """A finding of the baseline; stands: whether it is the baseline's lowest one in its basin."""
    run, threshold = baseline.run, problem.threshold
    was, there = before.stated - threshold, basin.finding
    if again.cost is None:
        statement = say(f"{before.label} of {run} is not compared: {again.reason}")
        return FindingChange(
            standing=Standing.NOT_COMPARED, before=before.label, now=None, evaluation=again.index,
            parameters=before.parameters, margin_before=was, statement=statement,
        )  # fmt: skip
    tolerance = _tolerance(problem, evidence, before, there)
    lower = stands and basin.cost < again.cost
    cost = basin.cost if lower else again.cost
    violated = before.stated <= min(baseline.threshold, threshold)
    standing = _standing(problem, evidence, (before.stated, again.cost, cost), violated, tolerance)
    if standing is Standing.FIXED and basin.violates(threshold):
        standing = Standing.BETTER
    elif standing is Standing.FIXED and not basin.resolved:
        standing = Standing.UNRESOLVED
    if standing in MENDED and violated and again.cost > threshold and _unconfirmed(problem, before, basin.known):
        standing = Standing.UNRESOLVED
    return FindingChange(
        standing=standing,
        before=before.label,
        now=None if there is None else there.label,
        evaluation=again.index,
        parameters=basin.parameters if lower else again.parameters,
        margin_before=was,
        margin_again=again.cost - threshold,
        margin=cost - threshold,
        change=cost - before.stated,
        tolerance=tolerance,
        newly_violating=cost <= threshold and not violated,
        statement=_described(problem, run, before, again.cost, cost, standing, basin),
    )


def _unconfirmed(problem: Problem, before: BaselineCase, known: CaseBasin | None) -> Spans:
    """Why a case that violated in the baseline, and not when it was evaluated here, may still violate; a clause, empty
    if it was confirmed as a finding is, and in results of earlier versions, which did not confirm it."""
    if known is None:
        return ()
    case = known.confirmed
    if case is None:
        return say("the allowance of validation did not suffice to confirm it")
    low = [value for value in case.values if value <= problem.threshold]
    if low:
        by = "evaluated again" if case.repeats is None else CALLED.strip()
        return say(f"{by} it violates with ", on_side(min(low), problem.threshold, problem.unit, "confirmed"))
    if not case.agrees:
        lacks = case.incomplete or (case.repeats is not None and case.repeats.failed > 0)
        return say(f"evaluated again it {'has no value' if lacks else 'differs by more than the tolerance'}")
    if case.repeats is None or before.calls is None or before.calls.differ(len(case.repeats.values), problem.threshold):
        return ()
    return _may_be_chance(problem, before.calls, len(case.repeats.values))


def _may_be_chance(problem: Problem, there: CallsThere, here: int) -> Spans:
    """Why so many calls of which none violates do not show that a violation is fixed."""
    run = "" if problem.campaign.baseline is None else problem.campaign.baseline.run
    few = sum(value <= problem.threshold for value in there.low)
    violated = say(count(few, "violating_there"), " of ", amount(there.made, "independent call", "calls_there"))
    if few:
        return say(violated, f" of {run} violated and none of ", count(here, "calls"), " here, which may be chance")
    again = f"run {run} again with a larger validate.repeats, or take a newer baseline"
    return say(violated, f" of {run} violated, as here, so that calls cannot show whether it is fixed: {again}")


def _own(problem: Problem, evidence: Evidence, before: BaselineCase, again: Reevaluated, basin: _Basin) -> _Basin:
    """The basin of a case; only the case itself where one between it and the finding is clear, or has no cost."""
    there, known = basin.finding, basin.known
    if there is None or known is None or known.line is None or again.cost is None:
        return basin
    highest, most = known.line.highest, max(problem.threshold, again.cost)
    if highest is not None and highest <= most + _tolerance(problem, evidence, before, there):
        return basin
    own = known.model_copy(update={"lowest": again.cost, "parameters": again.parameters})
    return _Basin(None, own, there.label)


def _standing(
    problem: Problem, evidence: Evidence, costs: tuple[float, float, float], violated: bool, tolerance: float
) -> Standing:
    """costs: in the baseline, on this model, the lowest known in its basin; violated: in the baseline."""
    before, again, cost = costs
    threshold, nominal = problem.threshold, evidence.nominal.cost
    if cost <= threshold and not violated:
        return Standing.WORSE
    if violated and cost > threshold:
        return Standing.FIXED
    # Where two searches of the same model end in a basin may differ by so much. The nominal cost alone is no scale: it
    # may be a large value that stands for "no encounter".
    size = max(abs(before), abs(cost), abs(threshold))
    search = 0.0 if nominal is None else rules.SAME_COST.value * min(max(nominal - cost, 0.0), size)
    search = min(search, rules.TOLERANCE_OF_MARGIN.value * abs(before - threshold))
    if again < before - tolerance or cost < before - max(tolerance, search):
        return Standing.WORSE
    return Standing.BETTER if cost > before + tolerance else Standing.SAME


def _new(problem: Problem, found: Finding, run: str, apart: str | None) -> FindingChange:
    """apart: the finding of the baseline that is in its basin, but is not the same."""
    cost, margin = on_side(found.granted, problem.threshold, problem.unit), found.granted - problem.threshold
    why = f"no finding of {run} is in its basin"
    if apart is not None:
        why = f"a case between it and {apart} of {run} does not violate"
    statement = say(finding(found.label), f" is new: {why}; ", symbol(problem.quantity))
    return FindingChange(
        standing=Standing.NEW,
        before=None,
        now=found.label,
        parameters=found.parameters,
        margin=margin,
        newly_violating=margin <= 0,
        statement=say(statement, " = ", cost, ", a margin of ", signed(margin, problem.unit, "margin")),
    )


def _tolerance(problem: Problem, evidence: Evidence, before: BaselineCase, there: Finding | None) -> float:
    """The largest of what the integrations differ by in either run, what calls differ by, the policy's, rounding."""
    measured = evidence.nominal.measured
    spread = 0.0 if measured is None or measured.spread is None else measured.spread
    now = difference(evidence.validation.nominal if there is None else there.validation)
    return max(
        before.difference, now, spread, problem.campaign.regression.tolerance, before.rounding(problem.threshold)
    )


def _beside(problem: Problem, evidence: Evidence, checks: Sequence[Check]) -> Spans:
    """Why known violations are not accepted, as a sentence; empty if nothing else is wrong."""
    but, findings = " The known violations are not accepted: ", evidence.findings
    most = problem.campaign.stages.findings.at_most
    if len(findings) >= most and all(found.granted <= problem.threshold for found in findings):
        return say(but, "all ", count(most), " findings that the campaign lists violate, and there may be more.")
    others = [check for check in checks if not check.ok and not _of_violations(check, problem, evidence)]
    wrong = [check.name if (rule := rules.rule(check.code)) is None else rule.title for check in others]
    return say(but, f"other checks fail ({', '.join(wrong)}).") if wrong else ()


def _of_violations(check: Check, problem: Problem, evidence: Evidence) -> bool:
    """Whether violations alone make a check fail."""
    rule = rules.rule(check.code)
    if rule is None or not rule.of_violations:
        return False
    if check.code in (CheckCode.PROBABILITY, CheckCode.TARGET):
        return evidence.sample is not None and evidence.sample.violations > 0
    return check.code != CheckCode.CALLS or calls.beside(problem, evidence)


def _fails(policy: Policy, case: FindingChange, strictest: float) -> bool:
    """strictest: the margin at or below which a case violates by the higher of both thresholds."""
    fail_on = policy.fail_on
    if case.standing in UNKNOWN:  # what was not examined must not hide a violation that was known
        known = case.margin_before is not None and case.margin_before <= strictest
        return "not_compared" in fail_on or ("violation" in fail_on and known)
    return (
        ("new_violation" in fail_on and case.newly_violating)
        or ("new" in fail_on and case.standing is Standing.NEW)
        or ("worse" in fail_on and case.standing is Standing.WORSE)
    )


def _described(
    problem: Problem, run: str, before: BaselineCase, again: float, cost: float, standing: Standing, basin: _Basin,
) -> Spans:  # fmt: skip
    quantity, unit = symbol(problem.quantity), problem.unit
    was, now = on_side(before.stated, problem.threshold, unit), on_side(again, problem.threshold, unit, "again")
    is_ = f"{before.label} of {run} is {IS.get(standing, standing)}: "
    by = "" if before.called is None else CALLED
    statement = say(is_, quantity, " = ", now, " on this model, ", was, " there", by)
    where = _where(problem, before, again, cost, standing, basin)
    return say(statement, "; ", where, "; a change of ", signed(cost - before.stated, unit, "change"))


def _where(
    problem: Problem, before: BaselineCase, again: float, cost: float, standing: Standing, basin: _Basin
) -> Spans:
    """A clause on what is known of the basin of a case."""
    unit, threshold, there, known = problem.unit, problem.threshold, basin.finding, basin.known
    if standing is Standing.UNRESOLVED:
        return _unconfirmed(problem, before, known) or say(_unexamined(known))
    if known is not None and known.violation is not None and basin.cost > threshold:
        at = f"evaluation {known.violation.index} of stage {known.violation.position}"
        value = on_side(known.violation.cost, threshold, unit, "lowest")
        return say(f"there is no barrier between it and {at}, which violates with ", value)
    if basin.apart is not None and known is not None and known.line is not None:
        highest = known.line.highest
        between = say("a case between it and ", finding(basin.apart))
        return say(between, " has ", "no cost" if highest is None else on_side(highest, threshold, unit))
    if cost < again or basin.cost <= threshold < again:
        lowest = on_side(basin.cost, threshold, unit, "lowest")
        if there is None:
            return say("its basin, which is not listed as a finding, has ", lowest)
        return say(finding(there.label), " in its basin has ", lowest, CALLED if basin.called else "")
    if there is not None:
        return say("it is in the basin of ", finding(there.label))
    return say("no finding of this run is in its basin")


def _unexamined(known: CaseBasin | None) -> str:
    left = "the allowance of validation did not suffice"
    if known is None or known.lowest is None:
        return f"{left} to descend from it"
    return f"{left} to look for a barrier between it and {known.not_compared} stored violations"


def _statement(problem: Problem, baseline: Baseline, cases: list[FindingChange], failing: list[FindingChange]) -> Spans:
    """How many findings have each standing, and which of them fail."""
    limits = baseline.threshold, problem.threshold
    counts = [
        say(count(many), f" {standing}")
        for standing in Standing
        if (many := sum(case.standing == standing for case in cases))
    ]
    whole = say(f"Changes of the findings since {baseline.run}: ", joined(", ", counts), ".")
    if limits[0] != limits[1]:
        there, here = (limit(each, problem.unit) for each in limits)
        whole = say(whole, " The threshold there is ", there, ", here it is ", here, ".")
    if not failing:
        return say(whole, " No change fails the policy of the campaign.")
    named = joined("; ", [case.statement for case in failing[:NAMED]])
    more = f"; and {len(failing) - NAMED} more." if len(failing) > NAMED else "."
    return say(whole, " The policy of the campaign fails: ", named, more)
