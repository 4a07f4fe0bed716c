"""The checks of a verdict: everything that must hold before a campaign is cleared, each with its sentence.

Start reading at `checks`.
"""

from __future__ import annotations

from campaigns.results.verdict import Check
from campaigns.wording import count, number, signed
from worker.stages.parts import distances
from worker.systems.problem import Problem
from worker.verdicts.agreement import agreement
from worker.verdicts.encounter import encounter
from worker.verdicts.evidence import Evidence
from worker.verdicts.probability import probability


def checks(problem: Problem, evidence: Evidence) -> list[Check]:
    """All checks in the order in which they are read."""
    return [
        _nominal(problem, evidence),
        _ended(evidence),
        _no_violation(problem, evidence),
        _minimum(problem, evidence),
        agreement(problem, evidence),
        _validated(evidence),
        _none_failed(evidence),
        *encounter(problem, evidence),
        *_distances(problem),
        *probability(problem, evidence),
    ]


def _nominal(problem: Problem, evidence: Evidence) -> Check:
    nominal, unit = evidence.nominal, problem.parts.criterion.unit
    if nominal.status != "ok" or nominal.cost is None or nominal.margin is None:
        return Check(name="nominal", ok=False, text=f"the nominal flight was not evaluated: {nominal.reason}")
    text = f"the nominal flight has {number(nominal.cost)} {unit}, margin {signed(nominal.margin)} {unit}"
    return Check(name="nominal", ok=nominal.margin > 0, text=text)


def _ended(evidence: Evidence) -> Check:
    ways = ", ".join(f"{s.title} {s.stop.text}" for s in evidence.searches if s.stop is not None)
    empty = [s.title for s in evidence.searches if s.best is None]
    if empty:
        return Check(name="search", ok=False, text=f"{' and '.join(empty)} evaluated no flight successfully")
    ended = "every search ended" if evidence.complete else "not every search ended"
    return Check(name="search", ok=evidence.complete, text=f"{ended}: {ways}")


def _no_violation(problem: Problem, evidence: Evidence) -> Check:
    """Over every stored evaluation, whichever stage asked for it."""
    finding, unit = evidence.finding, problem.parts.criterion.unit
    if finding is None:
        return Check(name="no violation", ok=False, text="no flight was evaluated")
    if finding.margin > 0 and not evidence.violating:
        return Check(
            name="no violation",
            ok=True,
            text=f"the worst flight found keeps a margin of {signed(finding.margin)} {unit}",
        )
    counts = evidence.violations.text
    if finding.margin > 0:
        return Check(name="no violation", ok=False, text=counts)
    confirmed = "confirmed" if finding.violates else "did not confirm"
    text = f"{finding.label} violates the criterion by {number(-finding.margin)} {unit}; validation {confirmed} it"
    return Check(name="no violation", ok=False, text=f"{text}; {counts}")


def _minimum(problem: Problem, evidence: Evidence) -> Check:
    """Nothing stored is lower than the worst finding, and it was polished to the end."""
    finding, unit = evidence.finding, problem.parts.criterion.unit
    if finding is None or evidence.lowest is None:
        return Check(name="minimum", ok=False, text="no flight was evaluated")
    if evidence.lowest < finding.cost:
        text = f"a stored evaluation has {number(evidence.lowest)} {unit}, lower than every finding"
        return Check(name="minimum", ok=False, text=text)
    gathered = evidence.gathered
    if not gathered.complete:
        return Check(
            name="minimum", ok=False, text=f"the worst cases were not distinguished to the end: {gathered.text}"
        )
    text = f"{finding.label} is the lowest of all {count(evidence.succeeded)} evaluations of all stages"
    return Check(name="minimum", ok=True, text=text)


def _validated(evidence: Evidence) -> Check:
    """Nominal and findings within tolerance, and no random evaluation on the other side of the threshold."""
    validation, spot = evidence.validation, evidence.spot_checks
    ok = validation.ok and not spot.violating and (spot.compared > 0 or not spot.checked)
    return Check(name="validation", ok=ok, text=f"{validation.text}; {spot.text}")


def _distances(problem: Problem) -> list[Check]:
    """Whether a vehicle inside an obstacle may count as clear; only where it may."""
    text = distances.overlooked(problem)
    return [Check(name="distances", ok=False, text=text)] if text else []


def _none_failed(evidence: Evidence) -> Check:
    total = count(evidence.evaluations)
    left_out = f", {count(evidence.excluded)} excluded" if evidence.excluded else ""
    if evidence.failed:
        return Check(
            name="evaluations", ok=False, text=f"{count(evidence.failed)} of {total} evaluations failed{left_out}"
        )
    return Check(name="evaluations", ok=True, text=f"none of {total} evaluations failed{left_out}")
