"""The checks of a verdict as displayed: a title for each code, and whether a check holds.

A check on values is open if evaluations failed: those have no value, so it holds for the others only. Shared by the
API, the report and the command line.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pydantic import computed_field

from campaigns import rules
from campaigns.claims.say import count, say
from campaigns.claims.spans import Spans, words
from campaigns.results.finding import Validation
from campaigns.results.remedies import Ran, Remedy, remedies
from campaigns.results.verdict import Check, Verdict

Standing = Literal["holds", "open", "fails"]


class DescribedCheck(Check):
    """A check as displayed: its title, whether it holds, and its limitation."""

    title: str
    standing: Standing
    """`open`: it holds for the evaluations that have a value, but others failed."""
    limit: Spans = ()
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


def checks_of(verdict: Verdict) -> list[DescribedCheck]:
    """The checks of a verdict, with the failed evaluations that it counts."""
    return described(verdict.checks, 0 if verdict.evaluations is None else verdict.evaluations.failed)


def _described(check: Check, failed: int, found: list[Remedy]) -> DescribedCheck:
    rule = rules.rule(check.code)
    limited = check.ok and failed > 0 and rule is not None and rule.of_values
    standing: Standing = "open" if limited else "holds" if check.ok else "fails"
    verb = "evaluation failed and has" if failed == 1 else "evaluations failed and have"
    limit = say(count(failed, "failed"), f" {verb} no value") if limited else ()
    title = check.code[:1].upper() + check.code[1:] if rule is None else rule.title
    return DescribedCheck(
        code=check.code,
        ok=check.ok,
        statement=check.statement,
        title=title,
        standing=standing,
        limit=limit,
        remedies=found,
    )


def validated(case: Validation | None) -> str:
    """The outcome of validating a nominal case or finding; `agrees` and `violates` are newer than `ok`."""
    if case is None:
        return "not validated"
    if case.repeats is not None:
        return case.repeats.text
    if case.agrees is None or case.violates is None:
        return "confirmed" if case.ok else "not confirmed"
    if case.incomplete:
        return f"not every {'integration' if case.again is None else 'evaluation'} has a value"
    if case.again is not None:
        agree = "evaluations agree" if case.agrees else "evaluations disagree"
        return f"violation confirmed, {agree}" if case.violates else agree
    if case.violates:
        return "violation confirmed, integrations agree" if case.agrees else "violation confirmed, beyond tolerance"
    return "integrations agree" if case.agrees else "integrations disagree"
