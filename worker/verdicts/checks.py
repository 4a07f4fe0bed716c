"""The checks of a verdict: everything that must hold before a campaign is cleared, each with its sentence.

Start reading at `checks`.
"""

from __future__ import annotations

from campaigns.wording import count, number, signed
from worker.stages.parts import distances
from worker.systems.problem import Problem
from worker.verdicts.agreement import agreement
from worker.verdicts.encounter import encounter
from worker.verdicts.evidence import Check, Evidence
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
    if nominal["status"] != "ok":
        return Check("nominal", False, f"the nominal flight was not evaluated: {nominal['reason']}")
    text = f"the nominal flight has {number(nominal['cost'])} {unit}, margin {signed(nominal['margin'])} {unit}"
    return Check("nominal", nominal["margin"] > 0, text)


def _ended(evidence: Evidence) -> Check:
    ways = ", ".join(f"{s['title']} {s['stop']['text']}" for s in evidence.searches)
    empty = [s["title"] for s in evidence.searches if s["best"] is None]
    if empty:
        return Check("search", False, f"{' and '.join(empty)} evaluated no flight successfully")
    ended = "every search ended" if evidence.complete else "not every search ended"
    return Check("search", evidence.complete, f"{ended}: {ways}")


def _no_violation(problem: Problem, evidence: Evidence) -> Check:
    """Over every stored evaluation, whichever stage asked for it."""
    finding, unit = evidence.finding, problem.parts.criterion.unit
    if finding is None:
        return Check("no violation", False, "no flight was evaluated")
    if finding.margin > 0 and not evidence.violating:
        return Check("no violation", True, f"the worst flight found keeps a margin of {signed(finding.margin)} {unit}")
    counts = str(evidence.validation["violations"]["text"])
    if finding.margin > 0:
        return Check("no violation", False, counts)
    confirmed = "confirmed" if finding.validation["violates"] else "did not confirm"
    text = f"{finding.label} violates the criterion by {number(-finding.margin)} {unit}; validation {confirmed} it"
    return Check("no violation", False, f"{text}; {counts}")


def _minimum(problem: Problem, evidence: Evidence) -> Check:
    """Nothing stored is lower than the worst finding, and it was polished to the end."""
    finding, unit = evidence.finding, problem.parts.criterion.unit
    if finding is None or evidence.lowest is None:
        return Check("minimum", False, "no flight was evaluated")
    if evidence.lowest < finding.cost:
        text = f"a stored evaluation has {number(evidence.lowest)} {unit}, lower than every finding"
        return Check("minimum", False, text)
    gathered = evidence.validation["findings"]
    if not gathered["complete"]:
        return Check("minimum", False, f"the worst cases were not distinguished to the end: {gathered['text']}")
    text = f"{finding.label} is the lowest of all {count(evidence.succeeded)} evaluations of all stages"
    return Check("minimum", True, text)


def _validated(evidence: Evidence) -> Check:
    """Nominal and findings within tolerance, and no random evaluation on the other side of the threshold."""
    validation = evidence.validation
    spot = validation["spot_checks"]
    ok = bool(validation["ok"]) and not spot["violating"] and (spot["compared"] > 0 or not spot["checked"])
    return Check("validation", ok, f"{validation['text']}; {spot['text']}")


def _distances(problem: Problem) -> list[Check]:
    """Whether a vehicle inside an obstacle may count as clear; only where it may."""
    text = distances.overlooked(problem)
    return [Check("distances", False, text)] if text else []


def _none_failed(evidence: Evidence) -> Check:
    total = count(evidence.evaluations)
    left_out = f", {count(evidence.excluded)} excluded" if evidence.excluded else ""
    if evidence.failed:
        return Check("evaluations", False, f"{count(evidence.failed)} of {total} evaluations failed{left_out}")
    return Check("evaluations", True, f"none of {total} evaluations failed{left_out}")
