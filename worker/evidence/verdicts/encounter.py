"""The encounter took place: conditions without which a cleared verdict shows nothing about the avoidance.

Each is a separate check with advice on what to change. An author may state in the campaign that one is intended
(`encounter.intended`); the check and the sentence then report this.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from campaigns import rules
from campaigns.claims.say import capital, case, count, limit, listed, number, on_side, say, symbol
from campaigns.claims.spans import Span, Spans, Text
from campaigns.codes import CheckCode
from campaigns.results.base import Status, ending
from campaigns.results.finding import ClosestApproach
from campaigns.results.nominal import NominalCase
from campaigns.results.validate import Beyond, Later, Unseen
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.agreement import varies
from worker.evidence.verdicts.alone import alone
from worker.evidence.verdicts.evidence import Evidence, check

INTENDED = ", which the author states is intended: "
BEYOND_INTENT = "; the author's statement permits only a closest approach at the start or at the end of the horizon"

Condition = tuple[bool, Spans]


def encounter(problem: Problem, evidence: Evidence) -> list[Check]:
    """One check for each condition; those that do not apply to the system and its criterion are omitted."""
    conditions: dict[CheckCode, Callable[[Problem, Evidence], Condition | None]] = {
        CheckCode.CLOSEST_APPROACH: _closest,
        CheckCode.MOTION: _motion,
        CheckCode.AVOIDANCE: _avoidance,
        CheckCode.INFLUENCE: _influence,
    }
    intended = {str(name): reason for name, reason in problem.campaign.encounter.intended.items()}
    found, shows = [], terms(problem.system).shows
    for code, condition in conditions.items():
        outcome = condition(problem, evidence) if code in (CheckCode.INFLUENCE, *shows) else None
        if outcome is None:
            continue
        ok, statement = outcome
        reason = intended.get(code.replace(" ", "_"))
        if not ok and reason is not None and code == CheckCode.CLOSEST_APPROACH and not _permitted(problem, evidence):
            statement = say(statement, BEYOND_INTENT)
        elif not ok and reason is not None and not (code == CheckCode.INFLUENCE and evidence.encounter.idle):
            ok, statement = True, say(_without_advice(statement), INTENDED, reason)
        found.append(check(code, ok, statement))
    return found


def stated(problem: Problem, checks: list[Check]) -> list[Spans]:
    """The conditions that do not hold but are intended according to the author, as sentences."""
    intended = problem.campaign.encounter.intended
    codes = {name.replace("_", " ") for name in intended}
    return [say(capital(c.statement), ".") for c in checks if c.code in codes and "is intended" in c.text]


def _without_advice(statement: Spans) -> Spans:
    """The sentence without the advice: up to the first semicolon."""
    for i, span in enumerate(statement):
        if isinstance(span, Text) and ";" in span.text:
            return say(statement[:i], span.text.partition(";")[0])
    return statement


def _closest(problem: Problem, evidence: Evidence) -> Condition | None:
    closest = {"nominal": evidence.encounter.closest}
    closest |= {f.label: f.closest or ClosestApproach() for f in evidence.findings}
    late, early, none = ([case(name) for name, c in closest.items() if c.at == at] for at in ("end", "start", "none"))
    longer = say("; lengthen the horizon of ", number(problem.campaign.given_scenario.horizon, "s", "horizon"))
    beyond = evidence.encounter.beyond
    if none:
        return False, say("no closest approach is known for ", listed(none))
    open_ = None if beyond is None else beyond.unknown
    if beyond is not None and beyond.closer and (open_ is None or beyond.least is not None):
        return False, say(_closer(problem, beyond), longer)
    if beyond is not None and open_ is not None:
        return False, say(_unknown(problem, beyond, open_), longer)
    if late:
        return False, say(
            *("the closest approach of ", listed(late), " is at the end of the horizon, before the encounter is over"),
            longer,
        )
    if early:
        return False, say(
            *("the closest approach of ", listed(early), " is at the start, before anything could be avoided; start "),
            "farther away, or move the goal to the other side of the obstacle",
        )
    statement = say("the closest approach of ", listed([*map(case, closest)]), " is inside the horizon")
    if beyond is None:
        return True, statement
    come = "comes closer beyond it" if terms(problem.system).followed else "comes lower"
    until = number(beyond.times * problem.campaign.given_scenario.horizon, "s", "until")
    flights = say(count(beyond.flights), " flight" if beyond.flights == 1 else " flights")
    statement = say(statement, ", and none of ", flights, f" {come} when simulated on to ", until)
    if beyond.cut_short:
        statement = say(statement, ", or until it fails,")
    if terms(problem.system).followed:
        statement = say(statement, " and extrapolated from there")
    if beyond.cut_short:
        statement = say(statement, "; ", _fail(problem, beyond))
    if not terms(problem.system).followed:
        statement = say(statement, "; nothing is known beyond that")
    return True, say(statement, _not_continued(beyond))


def _not_continued(beyond: Beyond) -> Spans:
    """How many evaluations are not simulated on; the nominal case and the findings may be among them, and are."""
    if not beyond.not_continued:
        return ()
    return say("; at most ", count(beyond.not_continued, "not_continued"), " further evaluations were not simulated on")


def within(problem: Problem, evidence: Evidence) -> Spans:
    """That a counted sample has flights that are not simulated on, a sentence; else empty."""
    beyond = evidence.encounter.beyond
    if not evidence.counted or beyond is None or not beyond.not_continued:
        return ()
    horizon = limit(problem.campaign.given_scenario.horizon, "s")
    flights = count(beyond.flights, "continued")
    return say(
        " These statistics are of flights of ", horizon, "; ", flights, " flights were simulated on beyond that."
    )


def _fail(problem: Problem, beyond: Beyond) -> Spans:
    """How many flights fail after the horizon."""
    fail = " of them fails after it, before " if beyond.cut_short == 1 else " of them fail after it, before "
    until = number(beyond.times * problem.campaign.given_scenario.horizon, "s", "until")
    return say(count(beyond.cut_short or 0), fail, until)


def _permitted(problem: Problem, evidence: Evidence) -> bool:
    """Whether nothing is wrong but closest approaches at the start or at the end of the horizon: all are known, and
    beyond the horizon no flight reaches the threshold."""
    beyond, every = evidence.encounter.beyond, [evidence.encounter.closest, *(f.closest for f in evidence.findings)]
    if any(closest is None or closest.at == "none" for closest in every):
        return False
    if beyond is None:
        return True
    return beyond.unknown is None and (beyond.lowest is None or beyond.lowest.value > problem.threshold)


def _closer(problem: Problem, beyond: Beyond) -> Spans:
    """How many flights come closer beyond the horizon, and where that of the lowest one is at the last sample."""
    come = "comes" if beyond.closer == 1 else "come"
    fail = say(" (", _fail(problem, beyond), ")") if beyond.cut_short else ()
    many = say(count(beyond.closer), " of ", count(beyond.flights), f" flights {come} closer beyond the horizon", fail)
    later = beyond.lowest
    if later is None:
        return many
    return say(
        *(many, " than any evaluation: ", _there(problem, later), ", and ", symbol(problem.quantity)),
        *(" falls to " if later.simulated else " would fall to ", _value(problem, later)),
        *(" after another ", number(later.time, "s", "after", 4)),
    )


def _value(problem: Problem, later: Later) -> Span:
    return on_side(later.value, problem.threshold, problem.unit, "later", 4)


def _unknown(problem: Problem, beyond: Beyond, later: Later) -> Spans:
    """That an obstacle which turns or has states approaches at the end of what is known of its motion, or the vehicle
    at the end of what is known of its own."""
    until = beyond.times * problem.campaign.given_scenario.horizon if later.until is None else later.until
    known = say(number(until, "s", "known"), "" if later.until is None else ", when the flight fails")
    if later.goal is not None:
        comes = say(" comes another ", number(later.goal, "s", "goal", 4), " after ", known)
        return say("it is not known how the vehicle moves on from its goal, to which ", case(later.name), comes)
    quantity, value = symbol(problem.quantity), _value(problem, later)
    straight = not later.vehicle and later.closing > 0
    moves = "the vehicle moves on" if later.vehicle else f"{_obstacle(problem, later)} moves"
    return say(
        *(f"it is not known how {moves} after ", known, ": ", _there(problem, later)),
        *("; ", "along straight lines " if straight else "", quantity),
        *(" would be " if straight else " could be ", value, " after another "),
        number(later.time, "s", "after", 4),
    )


def _there(problem: Problem, later: Later) -> Spans:
    """The words for the position of an obstacle at the last sample of a flight, and its closing speed."""
    moves = ", closing at " if later.closing > 0 else ", moving away at "
    return say(
        *(case(later.name), " is ", number(later.distance, "m", "distance", 4), " from ", _obstacle(problem, later)),
        *(" at the last sample", moves, number(abs(later.closing), "m/s", "closing", 4)),
    )


def _obstacle(problem: Problem, later: Later) -> str:
    return f"obstacle {later.obstacle + 1} ({terms(problem.system).obstacles[later.obstacle]})"


def _motion(problem: Problem, evidence: Evidence) -> Condition | None:
    moved, nominal = evidence.encounter.moved, evidence.nominal.cost
    if moved is None:
        return False, say("the vehicle's motion is unknown: the nominal case has no trace")
    statement = say("the vehicle moves ", number(moved, "m", "moved"), " in the nominal case")
    if nominal is None:
        return False, say(statement, ", which has no closest approach to compare this with")
    if moved <= rules.MOVED.value * abs(nominal):
        return False, say(statement, "; place the goal beyond the obstacle")
    return True, statement


def _avoidance(problem: Problem, evidence: Evidence) -> Condition | None:
    unseen, nominal = evidence.encounter.unseen, evidence.nominal.cost
    quantity, unit = symbol(problem.quantity), problem.unit
    if unseen is None:
        return None
    if nominal is None or unseen.cost is None:
        return False, _unknown_effect(problem, evidence.nominal, unseen)
    by, blind = nominal - unseen.cost, on_side(unseen.cost, problem.threshold, unit, "unseen")
    if by <= rules.ROUNDING.value * max(abs(nominal), abs(unseen.cost)):
        return False, say(
            *("the avoidance makes no difference: the nominal ", quantity, " is "),
            *(
                blind,
                " without it and ",
                on_side(nominal, problem.threshold, unit, "nominal"),
                " with it; place the obstacle where the vehicle would ",
            ),
            "come closer without avoidance",
        )
    return True, say("without avoidance the nominal ", quantity, " is ", blind)


def _unknown_effect(problem: Problem, nominal: NominalCase, unseen: Unseen) -> Spans:
    """Why the nominal case with and without avoidance cannot be compared."""
    why = "the effect of the avoidance is unknown: "
    choose = "; choose a nominal case that the vehicle completes"
    if nominal.cost is not None:
        return say(why, "without it the nominal case ", _ended(unseen), choose, " without avoidance")
    if unseen.cost is None:
        return say(why, "the nominal case ", _ended(nominal), ", and without avoidance it ", _ended(unseen), choose)
    blind = on_side(unseen.cost, problem.threshold, problem.unit, "unseen")
    return say(
        why,
        "with it the nominal case ",
        _ended(nominal),
        ", without it ",
        symbol(problem.quantity),
        " is ",
        blind,
        choose,
    )


def _ended(case: NominalCase | Unseen) -> str:
    """The words for a case without a value."""
    ends = "is excluded" if case.status == Status.EXCLUDED else "fails"
    return f"{ends} ({case.reason})" if case.reason else ends


def _influence(problem: Problem, evidence: Evidence) -> Condition:
    quantity, unit = symbol(problem.quantity), problem.unit
    begins, whole = evidence.encounter.begins, evidence.encounter.whole
    if never := [path for path, (first, _) in begins.items() if first >= _horizon(problem)]:
        return False, _never(problem, never[0], *begins[never[0]])
    if partly := [path for path, (first, _) in whole.items() if first > _horizon(problem)]:
        return False, _partly(problem, partly[0], *whole[partly[0]])
    if evidence.encounter.idle:
        return False, _idle(problem, evidence.encounter.idle)
    by = varies(evidence, problem.threshold)
    if not by:
        return False, _no_effect(problem, evidence)
    measured = evidence.nominal.measured
    if measured is not None and measured.deviation and by <= rules.ABOVE_NOISE.value * measured.deviation:
        noise = number(measured.deviation, unit, "deviation")
        return False, say(
            *(quantity, " varies by ", number(by, unit, "varies"), " over the evaluations, which may be noise alone: "),
            *("evaluations of the same point have a standard deviation of ", noise),
        )
    parameters, shown = problem.symbols, alone(evidence, problem.threshold)
    no_value = evidence.encounter.no_value
    without = [parameters[path] for path in parameters if path in shown.without and path not in no_value]
    statement = say(quantity, " varies by ", number(by, unit, "varies"), " over the evaluations")
    if without:
        more = "" if shown.fewest == shown.most else " or more"
        at = say(" at the ", count(shown.fewest), more, " values of each curve: ")
        statement = say(statement, "; varying these alone has no effect", at, listed(without))
    for path, (_, last) in (whole | begins).items():
        happens, name = ("first changes", "begins") if path in begins else ("has its whole effect", "whole")
        late = say(f"; {_part(problem, path)} {happens} at ", number(last, "s", name, 4), " with some values, ")
        statement = say(statement, late, "when no flight lasts as long")
    for path, statuses in no_value.items():
        if path not in shown.changing:
            seen = (
                " alone changes no value, but evaluations"
                if path in shown.known
                else " alone has no known effect: evaluations"
            )
            statement = say(statement, "; varying ", parameters[path], seen, " along it ", ending(statuses))
    return True, statement


def _never(problem: Problem, path: str, first: float, last: float) -> Spans:
    """That a fault, or the environment, first changes after the end of every flight."""
    then = _after_all(problem, first, last)
    return say(f"{_part(problem, path)} first changes at ", then, "; begin it earlier, or remove it")


def _partly(problem: Problem, path: str, first: float, last: float) -> Spans:
    """That a fault, or the environment, still builds up at the end of every flight."""
    then = _after_all(problem, first, last)
    instead = "; let it build up sooner, or state the part of it that flights meet"
    return say(f"{_part(problem, path)} has its whole effect only at ", then, instead)


def _after_all(problem: Problem, first: float, last: float) -> Spans:
    """Instants, and how long flights last."""
    then = say(number(first, "s", "first", 4), *(() if first == last else (" to ", number(last, "s", "last", 4))))
    return say(then, ", and flights last ", number(_horizon(problem), "s", "horizon", 4))


def _idle(problem: Problem, idle: Mapping[str, int]) -> Spans:
    """That faults, or parts of the environment, change no flight, so that nothing is shown about them."""
    parts, change = listed([_part(problem, path) for path in idle]), "changes" if len(idle) == 1 else "change"
    flights = count(min(idle.values()), "compared")
    what = "it, or give it values" if len(idle) == 1 else "them, or give them values"
    return say(parts, f" {change} none of ", flights, f" flights over the bounds; remove {what} that have an effect")


def _horizon(problem: Problem) -> float:
    return problem.campaign.given_scenario.horizon


def _part(problem: Problem, path: str) -> str:
    kind, _, k = path.partition(".")
    parts = getattr(problem.campaign.given_scenario, kind)
    return f"{path} ({(parts[int(k)] if k else parts).component})"


def _no_effect(problem: Problem, evidence: Evidence) -> Spans:
    """That the criterion does not vary, or that its evaluations cannot show whether it does."""
    spread, quantity = evidence.encounter.spread, symbol(problem.quantity)
    unknown = "the effect of the uncertain parameters is not known: "
    if not spread.evaluations:
        return say(unknown, "no evaluation has a value")
    if spread.one_point:
        return say(unknown, "only one point has a value; choose bounds within which evaluations succeed")
    lost = evidence.failed + evidence.excluded
    ended = [Status.FAILED] * bool(evidence.failed) + [Status.EXCLUDED] * bool(evidence.excluded)
    but = (
        say(", but ", count(lost), " of ", count(evidence.evaluations), " evaluations ", ending(ended)) if lost else ()
    )
    return say("no uncertain parameter changes ", quantity, but, "; choose parameters that the encounter depends on")
