"""The checks of a verdict as people read them: a title for each name, and how a check stands.

A check that speaks of values only is open where evaluations failed: those have no value, so that it holds for the
others alone. Shared by the API, the report and the command line. Start reading at `described`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

Standing = Literal["holds", "open", "fails"]

TITLES = {
    "nominal": "Nominal case",
    "search": "Searches ended",
    "no violation": "No violation",
    "minimum": "Lowest evaluation",
    "agreement": "Agreement of methods",
    "validation": "Integration",
    "evaluations": "Failed evaluations",
    "closest approach": "Closest approach",
    "motion": "Vehicle motion",
    "avoidance": "Effect of the avoidance",
    "influence": "Effect of the parameters",
    "noise": "Noise realisations",
    "exclusions": "Excluded starts",
    "probability": "Bound on P(violation)",
    "target": "Target for P(violation)",
}
"""By the name of a check; a check of an earlier version that is not listed is titled by its name."""

OF_VALUES = ("no violation", "minimum")
"""Checks that hold for the evaluations that have a value."""


def described(checks: Iterable[Mapping[str, Any]], failed: int) -> list[dict[str, Any]]:
    """Every check with its title, how it stands, and what limits it; failed: evaluations of the run that failed."""
    return [dict(check) | _words(check, failed) for check in checks]


def _words(check: Mapping[str, Any], failed: int) -> dict[str, str]:
    name = str(check["name"])
    limited = bool(check["ok"]) and failed > 0 and name in OF_VALUES
    standing: Standing = "open" if limited else "holds" if check["ok"] else "fails"
    verb = "evaluation failed and has" if failed == 1 else "evaluations failed and have"
    but = f"{failed:,} {verb} no value".replace(",", "\u202f") if limited else ""
    return {"title": TITLES.get(name, name[:1].upper() + name[1:]), "standing": standing, "but": but}


def validated(case: Mapping[str, Any]) -> str:
    """How the validation of a nominal case or finding came out; `agrees` and `violates` are newer than `ok`."""
    agrees, violates = case.get("agrees"), case.get("violates")
    if agrees is None or violates is None:
        return {"True": "confirmed", "False": "not confirmed"}.get(str(case.get("ok")), "not validated")
    if violates:
        return "violation confirmed, integrations agree" if agrees else "violation confirmed, beyond tolerance"
    return "integrations agree" if agrees else "integrations disagree"
