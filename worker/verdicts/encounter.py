"""The encounter took place: conditions without which a cleared flight shows nothing of the avoidance.

Each is a check of its own with what to change. An author may state in the campaign that one is meant
(`encounter.intended`), which the check and the sentence then say. Start reading at `encounter`.
"""

from __future__ import annotations

from collections.abc import Callable

from campaigns.results.finding import ClosestApproach
from campaigns.results.verdict import Check
from campaigns.wording import listed, number
from worker.systems.problem import Problem
from worker.verdicts.agreement import FLAT, varies
from worker.verdicts.evidence import Evidence

MOVED = 0.01
"""Fraction of the nominal closest approach that the vehicle must at least move."""


def encounter(problem: Problem, evidence: Evidence) -> list[Check]:
    """One check for each condition; those that cannot be asked of the criterion are left out."""
    conditions: dict[str, Callable[[Problem, Evidence], tuple[bool, str] | None]] = {
        "closest approach": _closest,
        "motion": _motion,
        "avoidance": _avoidance,
        "influence": _influence,
    }
    intended = {str(name): reason for name, reason in problem.campaign.encounter.intended.items()}
    found = []
    for name, condition in conditions.items():
        told = condition(problem, evidence)
        if told is None:
            continue
        ok, text = told
        reason = intended.get(name.replace(" ", "_"))
        if not ok and reason is not None:
            ok, text = True, f"{text.partition(';')[0]}, which the author states is intended: {reason}"
        found.append(Check(name=name, ok=ok, text=text))
    return found


def stated(problem: Problem, checks: list[Check]) -> list[str]:
    """What the author states to be intended, of the conditions that do not hold otherwise, as sentences."""
    intended = problem.campaign.encounter.intended
    names = {name.replace("_", " ") for name in intended}
    return [f"{c.text[0].upper()}{c.text[1:]}." for c in checks if c.name in names and "is intended" in c.text]


def _closest(problem: Problem, evidence: Evidence) -> tuple[bool, str] | None:
    if problem.parts.criterion.of != "obstacles":
        return None
    closest = {"nominal": evidence.encounter.closest}
    closest |= {f.label: f.closest or ClosestApproach() for f in evidence.findings}
    late, early, none = ([name for name, c in closest.items() if c.at == at] for at in ("end", "start", "none"))
    if none:
        return False, f"no closest approach is known of {listed(none)}"
    if late:
        return False, (
            f"the closest approach of {listed(late)} is at the end of the horizon, where the encounter is not over; "
            f"lengthen the horizon of {number(problem.campaign.scenario.horizon)} s"
        )
    if early:
        return False, (
            f"the closest approach of {listed(early)} is at the start, before anything could be avoided; start farther "
            "away, or move the goal to the other side of the obstacle"
        )
    return True, f"the closest approach of {listed(list(closest))} lies inside the horizon"


def _motion(problem: Problem, evidence: Evidence) -> tuple[bool, str] | None:
    moved, nominal = evidence.encounter.moved, evidence.nominal.cost
    if moved is None or nominal is None:
        return False, "how far the vehicle moves is not known: the nominal case has no trace"
    if moved <= MOVED * abs(nominal):
        return False, f"the vehicle moves {number(moved)} m in the nominal case; place the goal beyond the obstacle"
    return True, f"the vehicle moves {number(moved)} m in the nominal case"


def _avoidance(problem: Problem, evidence: Evidence) -> tuple[bool, str]:
    unseen, nominal = evidence.encounter.unseen, evidence.nominal.cost
    criterion = problem.parts.criterion
    quantity, unit = criterion.quantity, criterion.unit
    if nominal is None or unseen.cost is None:
        return False, (
            f"what the avoidance does could not be shown: without it the nominal case fails ({unseen.reason}); "
            "choose a nominal case that the vehicle completes without avoidance"
        )
    by = nominal - unseen.cost
    if by <= FLAT * max(abs(nominal), abs(unseen.cost)):
        return False, (
            f"the avoidance makes no difference: with every obstacle unseen the nominal {quantity} is "
            f"{number(unseen.cost)} {unit}, with the avoider {number(nominal)} {unit}; place the obstacle where the "
            "vehicle would come nearer without avoidance"
        )
    return True, f"with every obstacle unseen the nominal {quantity} would be {number(unseen.cost)} {unit}"


def _influence(problem: Problem, evidence: Evidence) -> tuple[bool, str]:
    quantity, unit = problem.parts.criterion.quantity, problem.parts.criterion.unit
    by = varies(evidence)
    if not by:
        return False, f"no uncertain parameter changes {quantity}; choose parameters that the encounter depends on"
    influence = evidence.encounter.influence
    without = [path for path, change in influence.items() if change <= FLAT * by]
    text = f"{quantity} varies by {number(by)} {unit} over the evaluations"
    return True, f"{text}; on the slices {listed(without)} alone changes nothing" if without else text
