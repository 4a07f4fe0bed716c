"""The calls of a simulator: do its results repeat, and if not, what may be claimed from several calls?

A simulator whose results differ is never cleared by single calls. With `repeats`, where an evaluation is the worst of
several calls, it is cleared only if none of the independent calls of the nominal case, the findings and the best of
every search violates or fails. A mean or a quantile over calls can hide a violation by one of them, so it never clears.
"""

from __future__ import annotations

from collections.abc import Iterator

from campaigns import rules
from campaigns.asked.spec import Simulator
from campaigns.claims.say import amount, capital, case, count, finding, joined, listed, number, on_side, say, sure
from campaigns.claims.spans import Spans
from campaigns.codes import CheckCode
from campaigns.results import Finding
from campaigns.results.finding import Validation
from campaigns.results.measured import Measured
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.evidence import Evidence, check


def calls(problem: Problem, evidence: Evidence) -> list[Check]:
    """The checks of a simulator's calls; none for a closed loop."""
    simulator, measured = problem.campaign.simulator, evidence.nominal.measured
    if simulator is None or measured is None:
        return []
    if simulator.calls > 1:
        ok, statement = _several(simulator, measured, problem, evidence)
    elif not measured.repeats:
        only_failures = not measured.identical and not measured.spread
        advice = _of_failures(problem) if only_failures else _of_values(problem, measured.deviation, evidence)
        ok, statement = False, say("the simulator ", measured.statement, "; ", advice)
    else:
        ok, statement = _later(measured, problem, evidence)
    return [*_retried(simulator, evidence), check(CheckCode.CALLS, ok, statement)]


def beside(problem: Problem, evidence: Evidence) -> bool:
    """Whether nothing is wrong with the calls of a simulator but that those of violations violate."""
    simulator, measured = problem.campaign.simulator, evidence.nominal.measured
    if simulator is None or measured is None or simulator.calls == 1:
        return False
    return _several(simulator, measured, problem, evidence, of_violations=False)[0]


def each(problem: Problem) -> str:
    """What an evaluation is, as a clause; empty if it is one call."""
    simulator = problem.campaign.simulator
    return "" if simulator is None or simulator.calls == 1 else f", each {_combined(simulator)}"


def stated(problem: Problem, checks: list[Check]) -> list[Spans]:
    """What a "cleared" verdict on a simulator with several calls rests on, as a sentence."""
    simulator = problem.campaign.simulator
    if simulator is None or simulator.calls == 1:
        return []
    return [say(capital(c.statement), ".") for c in checks if c.code == CheckCode.CALLS]


def repeated(problem: Problem, violation: Finding) -> Spans:
    """How many of the independent calls of a finding violate, as a sentence; empty for a system that repeats."""
    repeats = None if violation.validation is None else violation.validation.repeats
    if repeats is None:
        return ()
    lowest = min(v for v in repeats.values if v is not None)
    return say(
        *(" In calls independent of the search, ", finding(violation.label), " ", repeats.statement),
        *(" (", sure(repeats.confidence, ""), " confidence), the lowest at "),
        *(on_side(lowest, problem.threshold, problem.unit), "."),
    )


def proposed(deviation: float | None, margin: float | None) -> int:
    """How many calls an evaluation needs, by the ratio of the noise to the nominal margin."""
    if deviation is None or not margin:
        return rules.CALLS_UNMEASURED
    ratio = deviation / abs(margin)
    return next((calls for below, calls in rules.CALLS if ratio < below), rules.CALLS[-1][1])


def _of_values(problem: Problem, deviation: float | None, evidence: Evidence) -> Spans:
    """What to do where values differ."""
    calls = count(proposed(deviation, evidence.nominal.margin), "repeats")
    repeats = say("set simulator.repeats to {count: ", calls, ", combine: worst}")
    if not terms(problem.system).function:
        return repeats
    return say(
        "find what differs between calls of the function: state that it keeps, or random numbers that each call does "
        "not draw from a seed of its own; with clearance.simulator(isolated=True, recycle=1) every call has a process "
        "of its own; if the noise is intended, declare the function as a simulator and, in a campaign file, ",
        repeats,
    )


def _of_failures(problem: Problem) -> Spans:
    """What to do where evaluations of the same point fail only sometimes: of several calls, one makes them all fail."""
    function = terms(problem.system).function
    return say(
        "find out why, from the reasons of the failed evaluations",
        "" if function == "in_process" else "; if calls time out, raise the timeout",
        "" if function else "; simulator.retries tries a failed call again, which is counted and bars cleared",
    )


def _combined(simulator: Simulator) -> str:
    if simulator.repeats is not None and simulator.repeats.quantile is not None:
        return f"the {100 * simulator.repeats.quantile:g} % quantile of {simulator.calls} calls"
    return f"the {simulator.combine} of {simulator.calls} calls"


def _retried(simulator: Simulator, evidence: Evidence) -> list[Check]:
    if not (simulator.retries or evidence.flaky):  # a function without retries is called again where a batch raised
        return []
    statement = say("no call that failed succeeded when tried again")
    if evidence.flaky:
        statement = say(
            *(count(evidence.flaky, "flaky"), " of ", count(evidence.evaluations, "evaluations"), " evaluations "),
            "succeeded only when a call that had failed was tried again; find out why calls fail",
        )
    return [check(CheckCode.RETRIES, not evidence.flaky, statement)]


def _several(
    simulator: Simulator, measured: Measured, problem: Problem, evidence: Evidence, of_violations: bool = True
) -> tuple[bool, Spans]:
    """The check of evaluations by several calls; of_violations: whether a violation whose calls violate fails it."""
    cases = [*_cases(evidence)]
    apart = max((_range(v) for _, v in cases), default=0.0)
    is_ = say(
        f"each evaluation is {_combined(simulator)}; calls of the same case differ by up to ",
        *(number(apart, problem.unit, "apart"), ", evaluations by up to "),
        number(measured.spread or 0.0, problem.unit, "spread"),
    )
    if simulator.combine != "worst":
        return False, say(
            is_, f"; a {simulator.combine} can hide a violation by one of the calls; set combine to worst"
        )
    if measured.repeats and terms(problem.system).stepped:
        return False, say(
            *(is_, "; it repeats, and where an evaluation is several calls no case is evaluated at half the step; "),
            "remove simulator.repeats",
        )
    without = [name for name, v in cases if v.repeats is None]
    if without:
        return False, say(is_, "; no independent calls of ", listed(without))
    called, threshold = [(name, v, v.repeats) for name, v in cases if v.repeats is not None], problem.threshold
    counts = [of_violations or v.cost is None or v.cost > problem.threshold for _, v, _ in called]
    bad = [
        say(name, " ", r.statement)
        for (name, _, r), violating in zip(called, counts, strict=True)
        if r.failed or (r.violating and violating)
    ]
    bad += [say(name, " has no value to compare") for name, v, _ in called if v.cost is None]
    in_none = " in the search, and in none of its calls"
    lucky = [
        say(name, " violates with ", on_side(v.cost, threshold, problem.unit), in_none)
        for name, v, r in called
        if v.cost is not None and v.cost <= threshold and not r.violating
    ]
    if bad or lucky:
        return False, say(is_, "; in independent calls, ", joined("; ", [*bad, *lucky]))
    spot = evidence.spot_checks
    if spot.compared < spot.checked:
        lost = amount(spot.checked - spot.compared, "random evaluation", "lost")
        have = " has" if spot.checked - spot.compared == 1 else " have"
        return False, say(is_, "; ", lost, have, " no value when evaluated again")
    if measured.by_process:
        return False, say(
            *(is_, "; evaluations in one process repeat, but differ in another: calls in one process are not "),
            "independent; let each call have a process of its own (recycle: 1 in its descriptor)",
        )
    if evidence.sample is None or evidence.sample.noise != "drawn":
        return False, say(is_, "; add a certify stage, in which every sample is one call")
    many = sum(len(r.values) for _, _, r in called)
    return True, say(
        *(is_, "; none of ", count(many, "calls"), " independent calls of ", listed([name for name, _, _ in called])),
        " violates",
    )


def _range(case: Validation) -> float:
    """The largest difference between the independent calls of a case."""
    values = [] if case.repeats is None else [v for v in case.repeats.values if v is not None]
    return max(values) - min(values) if values else 0.0


def _cases(evidence: Evidence) -> Iterator[tuple[Spans, Validation]]:
    """The cases that are called again, by name."""
    validation = evidence.validation
    if validation.nominal is not None:
        yield say(case("nominal")), validation.nominal
    for found in evidence.findings:
        if found.validation is not None:
            yield say(finding(found.label)), found.validation
    for best in validation.incumbents:
        yield say(f"the best of {best.title}"), best.validation
    for again in validation.passing:
        yield say(case(again.name)), again


def _later(measured: Measured, problem: Problem, evidence: Evidence) -> tuple[bool, Spans]:
    """The check of a simulator that repeated when it was measured: every later comparison must show the same."""
    spot, apart = evidence.spot_checks, 0.0
    lost = [say("random evaluations")] if spot.compared < spot.checked else []
    compared = 0
    for name, validation in _cases(evidence):
        again = validation.again
        if again is not None and again.difference is not None:
            apart, compared = max(apart, abs(again.difference)), compared + 1
        elif again is None or again.cost is not None or validation.cost is not None:  # both failed: it repeats
            lost += [name]
    apart = max(apart, spot.largest or 0.0)
    if lost:
        without = say("evaluated again, not all of ", listed(lost), " have a value: the simulator does not repeat; ")
        return False, say(without, _of_failures(problem))
    if apart:
        differ = say("evaluated again, a case differs by ", number(apart, problem.unit, "apart"))
        return False, say(differ, "; ", _of_values(problem, apart, evidence))
    more = compared + spot.compared
    later = say(f"; so {'does' if more == 1 else 'do'} ", amount(more, "later comparison", "again"))
    return True, say(measured.statement, later)


def condition(evidence: Evidence, checks: list[Check]) -> str:
    """What a statement on P(violation) needs if only later comparisons showed that the simulator does not repeat."""
    differs = any(c.code == CheckCode.CALLS and not c.ok for c in checks)
    if not differs or evidence.sample is None or evidence.sample.noise != "none":
        return ""
    return " The simulator does not repeat, so this is over parameters and noise, if the noise of calls is independent."
