"""The checks of a verdict as people read them: a title for each name, and how a check stands.

A check that speaks of values only is open where evaluations failed: those have no value, so that it holds for the
others alone. Shared by the API, the report and the command line. Start reading at `described`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pydantic import computed_field

from campaigns.claims.codes import CheckCode
from campaigns.claims.say import count, say
from campaigns.claims.spans import Said, words
from campaigns.results.finding import Validation
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
    CheckCode.CLOSEST_APPROACH: "Closest approach",
    CheckCode.MOTION: "Vehicle motion",
    CheckCode.AVOIDANCE: "Effect of the avoidance",
    CheckCode.INFLUENCE: "Effect of the parameters",
    CheckCode.NOISE: "Noise realisations",
    CheckCode.EXCLUSIONS: "Excluded starts",
    CheckCode.PROBABILITY: "Bound on P(violation)",
    CheckCode.TARGET: "Target for P(violation)",
}
"""By the name of a check; a check of an earlier version that is not listed is titled by its name."""

OF_VALUES = (CheckCode.NO_VIOLATION, CheckCode.MINIMUM)
"""Checks that hold for the evaluations that have a value."""


class DescribedCheck(Check):
    """A check as it is read: its title, how it stands, and what limits it."""

    title: str
    standing: Standing
    """`open`: it holds for the evaluations that have a value, and others failed."""
    limit: Said = ()
    """What limits it; empty unless it is open."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def but(self) -> str:
        """What limits it, in plain words."""
        return words(self.limit)


def described(checks: Iterable[Check], failed: int) -> list[DescribedCheck]:
    """Every check with its title, how it stands, and what limits it; failed: evaluations of the run that failed."""
    return [_described(check, failed) for check in checks]


def _described(check: Check, failed: int) -> DescribedCheck:
    code = check.code
    limited = check.ok and failed > 0 and code in OF_VALUES
    standing: Standing = "open" if limited else "holds" if check.ok else "fails"
    verb = "evaluation failed and has" if failed == 1 else "evaluations failed and have"
    limit = say(count(failed, "failed"), f" {verb} no value") if limited else ()
    title = TITLES.get(code, code[:1].upper() + code[1:])
    return DescribedCheck(code=code, ok=check.ok, said=check.said, title=title, standing=standing, limit=limit)


def validated(case: Validation | None) -> str:
    """How the validation of a nominal case or finding came out; `agrees` and `violates` are newer than `ok`."""
    if case is None:
        return "not validated"
    if case.agrees is None or case.violates is None:
        return "confirmed" if case.ok else "not confirmed"
    if case.again is not None:
        agree = "evaluations agree" if case.agrees else "evaluations disagree"
        return f"violation confirmed, {agree}" if case.violates else agree
    if case.violates:
        return "violation confirmed, integrations agree" if case.agrees else "violation confirmed, beyond tolerance"
    return "integrations agree" if case.agrees else "integrations disagree"
