"""The validation of findings and the evidence that the encounter took place, as rows and sentences of the report.

Runs of earlier versions have fewer of them.
"""

from __future__ import annotations

from markupsafe import Markup

from backend.reports import words
from backend.reports.figures import Quantity
from backend.reports.record import Record
from campaigns.claims import numbers
from campaigns.claims.numbers import NONE
from campaigns.claims.say import joined, number, say, symbol
from campaigns.claims.spans import Spans
from campaigns.results import verdicts
from campaigns.results.base import ending
from campaigns.results.finding import ClosestApproach, Neighbours, Validation
from campaigns.results.validate import Beyond, Encounter, Later, Unseen

Row = dict[str, object]
FAR = "no obstacle is approaching"
_AT = {
    "start": "at the start of the horizon",
    "end": "at the end of the horizon",
    "inside": "inside the horizon",
    "none": "not known",
}


def cases(record: Record) -> list[Row]:
    validated = record.validated
    nominal = None if validated is None else validated.nominal
    found = [nominal, *(finding.validation for finding in record.findings)]
    return [_case(record.of, case) for case in found if case is not None]


def seed(case: Validation | None) -> str:
    """The noise realisation of a case."""
    return "" if case is None or case.realisation is None else f"noise seed {case.realisation}"


def _case(of: Quantity, case: Validation) -> Row:
    half, other, neighbours = case.half_step, case.integrator or case.again, case.neighbours
    called = [] if case.repeats is None else [value for value in case.repeats.values if value is not None]
    again = min(called, default=None) if other is None else other.cost
    halved = None if half is None else half.cost
    decimals = of.decimals([case.cost, halved, again], numbers.decimals_for([case.cost], 7))
    return {
        "name": case.name,
        "called": case.repeats is not None,
        "seed": seed(case),
        "cost": numbers.fixed(case.cost, decimals),
        "halved": half is not None,
        "half": numbers.fixed(halved, decimals),
        "half_by": numbers.plain(None if half is None else half.difference, 2),
        "other": numbers.fixed(again, decimals),
        "other_by": numbers.plain(None if other is None else other.difference, 2),
        "allowed": numbers.plain(case.allowed, 2),
        "neighbours": _neighbours(neighbours) if neighbours else NONE,
        "lower": numbers.plain(neighbours.lower_by, 2) if neighbours and neighbours.lowest is not None else NONE,
        "ok": case.ok,
        "word": verdicts.validated(case),
        "reason": _why(case),
    }


def _why(case: Validation) -> str:
    """Why there is no value at half the step, and of the other comparison."""
    half, other = case.half_step, case.integrator or case.again
    refused = f"at half the step: {half.reason}" if half is not None and half.reason else ""
    return "; ".join(filter(None, (refused, "" if other is None else other.reason)))


def _neighbours(flown: Neighbours) -> str:
    failed = f", {numbers.count(flown.failed)} failed" if flown.failed else ""
    return f"{numbers.count(flown.flown)}{failed}"


def again(record: Record) -> list[Spans]:
    """The repeated violations and random evaluations, and their differences."""
    result = record.validated
    if result is None:
        return []
    measured = [result.repeatability for result in record.every if result.repeatability is not None]
    found = [say("the simulator ", one.statement) for one in measured] + [
        part.statement for part in (result.violations, result.spot_checks) if part is not None and part.statement
    ]
    at = None if result.spot_checks is None else result.spot_checks.at
    if at is not None and at.cost != at.reference:
        seed = "" if at.realisation is None else f", noise seed {at.realisation}"
        symbols = {path: symbol(path, record.symbol(path)) for path in at.parameters}
        values = joined(", ", [say(symbols[path], " = ", number(value)) for path, value in at.parameters.items()])
        found.append(
            say(
                f"the largest difference is at {at.position}:{at.index}, the stage and index of evaluations.csv (",
                *(values, seed, "): ", number(at.cost, record.of.unit, digits=9), " and "),
                number(at.reference, record.of.unit, digits=9),
            )
        )
    return found


def encounter(record: Record) -> list[tuple[Markup, Markup]]:
    """The evidence that avoidance was exercised, as (quantity, result); empty if it was not examined."""
    validated, of = record.validated, record.of
    shown = None if validated is None else validated.encounter
    if shown is None:
        return []
    quantity = words.symbol_html(of.symbol)
    spread = shown.spread
    rows = [] if shown.unseen is None else _shown(record, shown, shown.unseen)
    if spread.lowest is not None:
        low, high = of.plain(spread.lowest), of.plain(spread.highest)
        text = f"{low} to {high} {of.unit} over {numbers.count(spread.evaluations)} evaluations"
        rows.append((Markup("Range of {}").format(quantity), Markup.escape(text)))
    changes = [
        Markup("{} {}").format(record.symbol_html(path), _change(record, shown, path))
        for path in shown.influence | shown.no_value
    ]
    rows.append((Markup("Largest change of {} on a slice").format(quantity), Markup("; ").join(changes)))
    return rows


def _change(record: Record, shown: Encounter, path: str) -> str:
    """The largest change by a parameter alone, and that evaluations along its slices have no value."""
    by, statuses = shown.influence.get(path), shown.no_value.get(path)
    change = "not known" if by is None else f"{numbers.plain(by, 3)} {record.of.unit}"
    return f"{change} (evaluations along it {ending(statuses)})" if statuses else change


def _shown(record: Record, shown: Encounter, unseen: Unseen) -> list[tuple[Markup, Markup]]:
    """Closest approach, path and the case without avoidance, for a system that provides them."""
    of = record.of
    value = f"{of.plain(unseen.cost)} {of.unit}" if unseen.cost is not None else f"no value: {unseen.reason}"
    approaches = [("nominal", shown.closest), *((f.label, f.closest) for f in record.findings)]
    closest = "; ".join(_closest(name, approach) for name, approach in approaches if approach is not None)
    rows = [(Markup.escape("Closest approach"), Markup.escape(closest))]
    if shown.beyond is not None:
        rows.append((Markup.escape("Beyond the horizon"), Markup.escape(_beyond(record, shown.beyond))))
    moved = "not known" if shown.moved is None else f"{numbers.plain(shown.moved)} m"
    rows.append((Markup.escape("Path length of the nominal case"), Markup.escape(moved)))
    rows.append(
        (Markup("Nominal {} with every obstacle unseen").format(words.symbol_html(of.symbol)), Markup.escape(value))
    )
    return rows


def _closest(name: str, approach: ClosestApproach) -> str:
    time = "" if approach.time is None else f" at {numbers.fixed(approach.time, 2)} s,"
    return f"{name}{time} {_AT[approach.at]}"


def _beyond(record: Record, beyond: Beyond) -> str:
    """What flights that are simulated on meet after the horizon."""
    many = f"{numbers.count(beyond.closer)} of {numbers.count(beyond.flights)} flights come closer"
    measured = _measured(record)
    far = [] if beyond.lowest or beyond.unknown else [FAR]
    shown = [many, *(far if measured else [f"nothing is known beyond {beyond.times:g} times the horizon"])]
    shown += (
        [f"{numbers.count(beyond.not_continued)} evaluations at most were not simulated on"]
        if beyond.not_continued
        else []
    )
    fail, on = "fails" if beyond.cut_short == 1 else "fail", ", extrapolated from there" if measured else ""
    shown += [f"{numbers.count(beyond.cut_short)} {fail} after the horizon{on}"] if beyond.cut_short else []
    shown += [f"lowest approach after it: {_later(record, beyond.least)}"] if beyond.least else []
    if beyond.unknown:
        what = "the vehicle" if beyond.unknown.vehicle else "the obstacle"
        shown.append(f"not known how {what} moves on: {_later(record, beyond.unknown)}")
    return "; ".join(shown)


def _measured(record: Record) -> bool:
    """Whether the criterion measures distances to obstacles: of others nothing is extrapolated."""
    return any(criterion.measured_to for criterion in record.run.criteria[:1])


def _later(record: Record, later: Later) -> str:
    of, plain = record.of, numbers.plain
    how = "simulated" if later.simulated else "extrapolated"
    away = f"obstacle {later.obstacle + 1}, {plain(later.distance)} m away at the last sample"
    value = f"{of.symbol} {of.plain(later.value)} {of.unit} after another {plain(later.time)} s ({how})"
    moves = "closing" if later.closing > 0 else "moving away"
    until = "" if later.until is None else f", fails after {plain(later.until)} s"
    return f"{later.name}, {away}, {moves} at {plain(abs(later.closing))} m/s{until}; {value}"
