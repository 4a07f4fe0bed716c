"""What was simulated again, and what shows that the encounter took place, as rows and sentences of the report.

Runs of earlier versions have less. Start reading at `cases`.
"""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from backend.reports import words
from backend.reports.held import Held
from backend.reports.words import NONE
from campaigns.results import ValidateResult, verdicts
from campaigns.results.finding import ClosestApproach, Validation

Row = dict[str, Any]
_AT = {
    "start": "at the start of the horizon",
    "end": "at the end of the horizon",
    "inside": "inside the horizon",
    "none": "not known",
}


def cases(held: Held) -> list[Row]:
    """Each case simulated again by other means: the nominal one, then the findings."""
    validated = held.result(ValidateResult)
    nominal = None if validated is None else validated.nominal
    found = [nominal, *(finding.validation for finding in held.findings)]
    return [_case(case) for case in found if case is not None]


def _case(case: Validation) -> Row:
    decimals = words.decimals_for([case.cost], 7)
    half, other, neighbours = case.half_step, case.integrator, case.neighbours
    return {
        "name": case.name,
        "seed": "" if case.realisation is None else f"noise seed {case.realisation}",
        "cost": words.fixed(case.cost, decimals),
        "half": words.fixed(half.cost, decimals),
        "half_by": words.plain(half.difference, 2),
        "other": words.fixed(other.cost, decimals),
        "other_by": words.plain(other.difference, 2),
        "allowed": words.plain(case.allowed, 2),
        "neighbours": words.count(neighbours.flown) if neighbours else NONE,
        "lower": words.plain(neighbours.lower_by, 2) if neighbours else NONE,
        "ok": case.ok,
        "word": verdicts.validated(case),
        "reason": other.reason,
    }


def again(held: Held) -> list[str]:
    """The stored violations and the random evaluations that were simulated again, and how far apart they were."""
    result = held.result(ValidateResult)
    if result is None:
        return []
    found = [part.text for part in (result.violations, result.spot_checks) if part is not None and part.text]
    at = None if result.spot_checks is None else result.spot_checks.at
    if at is not None:
        seed = "" if at.realisation is None else f", noise seed {at.realisation}"
        values = ", ".join(f"{path} = {words.plain(value)}" for path, value in at.parameters.items())
        unit = held.of.unit
        found.append(
            f"the two are furthest apart at evaluation {words.count(at.index + 1)} of stage {at.position + 1} "
            f"({values}{seed}): {words.plain(at.cost, 9)} {unit} and {words.plain(at.reference, 9)} {unit}"
        )
    return found


def encounter(held: Held) -> list[tuple[Markup, Markup]]:
    """What shows that the avoidance was tested, as pairs of what and result; empty where it was not examined."""
    validated, of = held.result(ValidateResult), held.of
    told = None if validated is None else validated.encounter
    if told is None:
        return []
    quantity = words.sign(of.symbol)
    unseen, spread = told.unseen, told.spread
    value = f"{words.plain(unseen.cost)} {of.unit}" if unseen.cost is not None else f"fails: {unseen.reason}"
    approaches = [("nominal", told.closest), *((f.label, f.closest) for f in held.findings)]
    closest = "; ".join(_closest(name, approach) for name, approach in approaches if approach is not None)
    rows = [(Markup.escape("Closest approach"), Markup.escape(closest))]
    moved = "not known" if told.moved is None else f"{words.plain(told.moved)} m"
    rows.append((Markup.escape("Path length of the nominal case"), Markup.escape(moved)))
    rows.append((Markup("Nominal {} with every obstacle unseen").format(quantity), Markup.escape(value)))
    if spread.lowest is not None:
        low, high = words.plain(spread.lowest), words.plain(spread.highest)
        text = f"{low} to {high} {of.unit} over {words.count(spread.evaluations)} evaluations"
        rows.append((Markup("Range of {}").format(quantity), Markup.escape(text)))
    changes = [
        Markup("{} {}").format(words.sign(held.symbol(path), path), f"{words.plain(by, 3)} {of.unit}")
        for path, by in told.influence.items()
    ]
    rows.append((Markup("Largest change of {} on a slice").format(quantity), Markup("; ").join(changes)))
    return rows


def _closest(name: str, approach: ClosestApproach) -> str:
    time = "" if approach.time is None else f" at {words.fixed(approach.time, 2)} s,"
    return f"{name}{time} {_AT[approach.at]}"
