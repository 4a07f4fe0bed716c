"""The checks of a verdict as people read them: a title for each name, and how a check stands.

A check that speaks of values only is open where evaluations failed: those have no value, so that it holds for the
others alone. Shared by the API, the report and the command line. Start reading at `described`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from campaigns.results.finding import Validation
from campaigns.results.verdict import Check
from campaigns.wording import count

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


class DescribedCheck(Check):
    """A check as it is read: its title, how it stands, and what limits it."""

    title: str
    standing: Standing
    """`open`: it holds for the evaluations that have a value, and others failed."""
    but: str
    """What limits it; empty unless it is open."""


def described(checks: Iterable[Check], failed: int) -> list[DescribedCheck]:
    """Every check with its title, how it stands, and what limits it; failed: evaluations of the run that failed."""
    return [_described(check, failed) for check in checks]


def _described(check: Check, failed: int) -> DescribedCheck:
    name = check.name
    limited = check.ok and failed > 0 and name in OF_VALUES
    standing: Standing = "open" if limited else "holds" if check.ok else "fails"
    verb = "evaluation failed and has" if failed == 1 else "evaluations failed and have"
    but = f"{count(failed)} {verb} no value" if limited else ""
    title = TITLES.get(name, name[:1].upper() + name[1:])
    return DescribedCheck(name=name, ok=check.ok, text=check.text, title=title, standing=standing, but=but)


def validated(case: Validation | None) -> str:
    """How the validation of a nominal case or finding came out; `agrees` and `violates` are newer than `ok`."""
    if case is None:
        return "not validated"
    if case.agrees is None or case.violates is None:
        return "confirmed" if case.ok else "not confirmed"
    if case.violates:
        return "violation confirmed, integrations agree" if case.agrees else "violation confirmed, beyond tolerance"
    return "integrations agree" if case.agrees else "integrations disagree"
