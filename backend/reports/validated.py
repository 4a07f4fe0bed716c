"""What was simulated again, and what shows that the encounter took place, as rows and sentences of the report.

Runs of earlier versions have cases only. Start reading at `cases`.
"""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from backend.reports import words
from backend.reports.held import Held
from backend.reports.words import NONE
from campaigns import verdicts

Row = dict[str, Any]
_AT = {
    "start": "at the start of the horizon",
    "end": "at the end of the horizon",
    "inside": "inside the horizon",
    "none": "not known",
}


def cases(held: Held) -> list[Row]:
    """Each case simulated again by other means."""
    rows = []
    for case in held.result("validate").get("cases", []):
        decimals = words.decimals_for([case.get("cost")], 7)
        half, other = case.get("half_step") or {}, case.get("integrator") or {}
        beside = case.get("neighbours") or {}
        seed = case.get("realisation")
        rows.append({
            "name": case.get("name", ""),
            "seed": "" if seed is None else f"noise seed {seed}",
            "cost": words.fixed(case.get("cost"), decimals),
            "half": words.fixed(half.get("cost"), decimals),
            "half_by": words.plain(half.get("difference"), 2),
            "other": words.fixed(other.get("cost"), decimals),
            "other_by": words.plain(other.get("difference"), 2),
            "allowed": words.plain(case.get("allowed"), 2),
            "neighbours": words.count(beside["flown"]) if beside else NONE,
            "lower": words.plain(beside.get("lower_by"), 2) if beside else NONE,
            "ok": case.get("ok") is True,
            "word": _word(case),
            "reason": other.get("reason") or "",
        })  # fmt: skip
    return rows


def _word(case: dict[str, Any]) -> str:
    if "agrees" in case:
        return verdicts.validated(case)
    return "agrees" if case.get("ok") is True else "differs"


def again(held: Held) -> list[str]:
    """The stored violations and the random evaluations that were simulated again, and how far apart they were."""
    result = held.result("validate")
    found = [str((result.get(key) or {}).get("text") or "") for key in ("violations", "spot_checks")]
    at = (result.get("spot_checks") or {}).get("at")
    if at:
        seed = "" if at.get("realisation") is None else f", noise seed {at['realisation']}"
        values = ", ".join(f"{path} = {words.plain(value)}" for path, value in at["parameters"].items())
        unit = held.of.unit
        found.append(
            f"the two are furthest apart at evaluation {words.count(at['index'] + 1)} of stage {at['position'] + 1} "
            f"({values}{seed}): {words.plain(at['cost'], 9)} {unit} and {words.plain(at['reference'], 9)} {unit}"
        )
    return [text for text in found if text]


def encounter(held: Held) -> list[tuple[Markup, Markup]]:
    """What shows that the avoidance was tested, as pairs of what and result; empty where it was not examined."""
    told, of = held.result("validate").get("encounter"), held.of
    if not told:
        return []
    quantity = words.sign(of.symbol)
    unseen, spread = told["unseen"], told["spread"]
    value = f"{words.plain(unseen['cost'])} {of.unit}" if unseen["cost"] is not None else f"fails: {unseen['reason']}"
    rows = [(Markup.escape("Closest approach"), Markup.escape("; ".join(_closest(c) for c in told["closest"])))]
    moved = "not known" if told["moved"] is None else f"{words.plain(told['moved'])} m"
    rows.append((Markup.escape("Path length of the nominal case"), Markup.escape(moved)))
    rows.append((Markup("Nominal {} with every obstacle unseen").format(quantity), Markup.escape(value)))
    if spread["lowest"] is not None:
        low, high = words.plain(spread["lowest"]), words.plain(spread["highest"])
        text = f"{low} to {high} {of.unit} over {words.count(spread['evaluations'])} evaluations"
        rows.append((Markup("Range of {}").format(quantity), Markup.escape(text)))
    changes = [
        Markup("{} {}").format(words.sign(held.symbol(path), path), f"{words.plain(by, 3)} {of.unit}")
        for path, by in told["influence"].items()
    ]
    rows.append((Markup("Largest change of {} on a slice").format(quantity), Markup("; ").join(changes)))
    return rows


def _closest(told: dict[str, Any]) -> str:
    time = "" if told["time"] is None else f" at {words.fixed(told['time'], 2)} s,"
    return f"{told['name']}{time} {_AT[told['at']]}"
