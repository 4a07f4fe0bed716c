"""What a verdict states of excluded evaluations: how many, by what, and the reasons that a simulator gave."""

from __future__ import annotations

from campaigns import rules
from campaigns.claims.say import count, joined, percent, probability_on_side, say
from campaigns.claims.spans import Spans
from campaigns.codes import CheckCode
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.scopes.terms import terms
from worker.evidence.verdicts.evidence import Evidence, check

MOST = 3
"""So many reasons are stated, the most frequent first."""


def exclusions(problem: Problem, evidence: Evidence) -> list[Check]:
    """The check of the excluded fraction, whoever excluded; empty if nothing was excluded."""
    if not evidence.excluded:
        return []
    drawn = 0.0 if evidence.sample is None else evidence.sample.excluded_fraction
    # A large sample where its distribution is narrow would hide what is excluded elsewhere within the bounds.
    searched = max((one.excluded / max(one.evaluations, 1) for one in evidence.searches), default=0.0)
    fractions = {
        "draws of the sample": drawn,
        "evaluations of a search": searched,
        "evaluations": evidence.excluded / max(evidence.evaluations, 1),
    }
    of, much = max(fractions.items(), key=lambda one: one[1])
    most = rules.EXCLUDED.value
    why = reasons(problem, evidence, "" if of == "evaluations" else "in all stages ")
    by = say(" were excluded", why) if why else " start at or below the threshold and were excluded"
    if terms(problem.system).own_rule:
        by = " were excluded by the criterion's own rule"
    statement = say(probability_on_side(much, most, "excluded"), f" of the {of}", by, ": nothing is known about them")
    if much > most:
        statement = say(statement, "; narrow the bounds until at most ", percent(most, 6, "most"), " are excluded")
    return [check(CheckCode.EXCLUSIONS, much <= most, statement)]


def reasons(problem: Problem, evidence: Evidence, where: str = "") -> Spans:
    """ " by the simulator (12 \u201cstarts inside the zone\u201d)"; empty if the scenario's precondition excludes.

    where: what they are counted over, if not what the sentence speaks of.
    """
    if problem.campaign.simulator is None or not evidence.excluded:
        return ()
    found = sorted(evidence.exclusions.items(), key=lambda of: (-of[1], of[0]))
    stated = [say(count(n), f" \u201c{why}\u201d" if why else " without a reason") for why, n in found[:MOST]]
    rest = len(found) - MOST
    more = [f"{rest} other reason{'s' if rest > 1 else ''}"] if rest > 0 else []
    return say(" by the simulator", *((f" ({where}", joined(", ", [*stated, *more]), ")") if found else ()))
