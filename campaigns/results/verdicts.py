"""The checks of a verdict as displayed: a title for each code, and whether a check holds.

A check on values is open if evaluations failed: those have no value, so it holds for the others only. Shared by the
API, the report and the command line.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pydantic import computed_field

from campaigns.claims.codes import CheckCode
from campaigns.claims.say import count, say
from campaigns.claims.spans import Said, words
from campaigns.results.finding import Validation
from campaigns.results.remedies import Ran, Remedy, remedies
from campaigns.results.verdict import Check

Standing = Literal["holds", "open", "fails"]

TITLES: dict[str, str] = {
    CheckCode.NOMINAL: "Nominal case",
    CheckCode.SEARCH: "Searches ended",
    CheckCode.NO_VIOLATION: "No violation",
    CheckCode.MINIMUM: "Lowest evaluation",
    CheckCode.AGREEMENT: "Agreement of methods",
    CheckCode.VALIDATION: "Integration",
    CheckCode.REPETITION: "Repeated evaluation",
    CheckCode.EVALUATIONS: "Failed evaluations",
    CheckCode.RETRIES: "Calls tried again",
    CheckCode.CALLS: "Noise of the simulator",
    CheckCode.CLOSEST_APPROACH: "Closest approach",
    CheckCode.MOTION: "Vehicle motion",
    CheckCode.AVOIDANCE: "Effect of the avoidance",
    CheckCode.INFLUENCE: "Effect of the parameters",
    CheckCode.NOISE: "Noise realisations",
    CheckCode.EXCLUSIONS: "Excluded starts",
    CheckCode.PROBABILITY: "Bound on P(violation)",
    CheckCode.TARGET: "Target for P(violation)",
}
"""By the code of a check; a check of an earlier version that is not listed has its code as title."""

OF_VALUES = (CheckCode.NO_VIOLATION, CheckCode.MINIMUM)
"""Checks that hold for the evaluations that have a value."""


class DescribedCheck(Check):
    """A check as displayed: its title, whether it holds, and its limitation."""

    title: str
    standing: Standing
    """`open`: it holds for the evaluations that have a value, but others failed."""
    limit: Said = ()
    """Its limitation; empty unless it is open."""
    remedies: list[Remedy] = []
    """Changes of the campaign with which a new run may settle it; empty if it holds, or if there is none."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def but(self) -> str:
        """Its limitation, as plain text."""
        return words(self.limit)


def described(checks: Iterable[Check], failed: int, ran: Ran | None = None) -> list[DescribedCheck]:
    """Every check with its title, whether it holds, its limitation and, if `ran` is given, its remedies; failed: failed
    evaluations of the run."""
    return [_described(check, failed, [] if ran is None else remedies(check, ran)) for check in checks]


def _described(check: Check, failed: int, found: list[Remedy]) -> DescribedCheck:
    code = check.code
    limited = check.ok and failed > 0 and code in OF_VALUES
    standing: Standing = "open" if limited else "holds" if check.ok else "fails"
    verb = "evaluation failed and has" if failed == 1 else "evaluations failed and have"
    limit = say(count(failed, "failed"), f" {verb} no value") if limited else ()
    title = TITLES.get(code, code[:1].upper() + code[1:])
    return DescribedCheck(
        code=code, ok=check.ok, said=check.said, title=title, standing=standing, limit=limit, remedies=found
    )


def validated(case: Validation | None) -> str:
    """The outcome of validating a nominal case or finding; `agrees` and `violates` are newer than `ok`."""
    if case is None:
        return "not validated"
    if case.repeats is not None:
        return case.repeats.text
    if case.agrees is None or case.violates is None:
        return "confirmed" if case.ok else "not confirmed"
    if case.again is not None:
        agree = "evaluations agree" if case.agrees else "evaluations disagree"
        return f"violation confirmed, {agree}" if case.violates else agree
    if case.violates:
        return "violation confirmed, integrations agree" if case.agrees else "violation confirmed, beyond tolerance"
    return "integrations agree" if case.agrees else "integrations disagree"
