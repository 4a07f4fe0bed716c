"""Agreement: did the methods find the same worst case at the same cost?

A method's own best counts if it is in the basin of a listed finding (by the findings' own test) and its cost is within
the campaign's `agreement` and a tenth of the margin of the worst; so mirrored worst cases agree. A method counts only
if it really searched: with a minimum budget, until its own stopping rule or the end of its budget, and to a best below
nominal. Methods of one family search by the same principle and miss the same cases: they count once. A search that the
campaign started at the worst case is no witness of it. A search of several parts that do not share their
evaluations counts as so many methods; parts that shared what they knew are one, of all their principles together: which
of them was the lowest is no principle of its own, and a search by the principle of any of them no second one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from campaigns import rules
from campaigns.claims.say import Part as Said
from campaigns.claims.say import count, finding, joined, listed, method, number, on_side, say
from campaigns.claims.spans import Span, Spans
from campaigns.codes import CheckCode
from campaigns.limits import SAME_PLACE
from campaigns.results import SearchResult
from campaigns.results.validate import Compared
from campaigns.results.verdict import Check
from worker.engine.problem.problem import Problem
from worker.evidence.verdicts.evidence import Evidence, check


def agreement(problem: Problem, evidence: Evidence) -> Check:
    """Whether every global method found the worst case known from any source, and two families of methods found it."""
    known, nominal, unit = evidence.finding, evidence.nominal.cost, problem.unit
    if known is None:
        return _check(False, "there is no worst case to agree on")
    if nominal is None:
        return _check(False, "the nominal case has no value, and without it the agreement has no scale")
    aiming = [s for s in evidence.searches if rules.FAMILIES[s.kind].least is not None]
    globally = [s for s in aiming if rules.FAMILIES[s.kind].all_agree]
    if not globally:
        return _check(False, "no global method searched; add one, such as DIRECT")
    lazy = [statement for s in globally if (statement := _not_searched(s, problem.dimension))]
    if lazy:
        return _check(False, joined("; ", lazy))
    # No method has evaluated the cases that drew their own noise.
    worst = min([f.cost for f in evidence.findings if f.realisation is None], default=known.cost)
    flat = not varies(evidence, problem.threshold)
    within = math.inf if flat else allowed(problem, nominal, worst)
    late = [statement for s in globally if (statement := _stopped_short(s, worst, within, problem))]
    if late:
        value = on_side(worst, problem.threshold, unit, "worst")
        return _check(False, "the worst case is ", value, ", but ", joined(" and ", late))
    elsewhere = [_titled(s) for s in globally if _row(s, evidence).basin is None]
    if elsewhere:
        return _check(False, "the best of ", listed(elsewhere), " is not in the basin of any listed finding")
    counted = [
        part for s in aiming if not _not_searched(s, problem.dimension) for part in _parts(s, evidence)
        if part.evaluations >= _least(s, problem.dimension) and part.best - worst <= within and part.finding is not None
        and not _starts_at_finding(s, part, problem, evidence)
    ]  # fmt: skip
    found = _agreed(counted, evidence, flat, worst, nominal, unit)
    dependents = [
        _titled(s)
        for s in aiming
        if any(_starts_at_finding(s, part, problem, evidence) for part in _parts(s, evidence))
    ]
    if found.ok or not dependents:
        return found
    started = say(listed(dependents), " started at it, as the campaign states, and does not confirm it")
    return _check(False, found.statement if counted else "no other search reached the worst case", "; ", started)


def _starts_at_finding(search: SearchResult, part: Part, problem: Problem, evidence: Evidence) -> bool:
    """Whether a start of the campaign is where the worst case is in whose basin this part ended."""
    requested = problem.campaign.stages.search[_index(search, evidence)].starts
    places = [np.array(f.point) for f in evidence.findings if f.label == part.finding]
    starts = [problem.point(start) for start in requested] if places else []
    return any(np.abs(start - place).max() <= SAME_PLACE for start in starts for place in places)


@dataclass(frozen=True)
class Part:
    """What one search found by itself, or one of its parts that were apart: its best and the finding in whose basin
    that is."""

    title: Span
    family: str
    evaluations: int
    best: float
    finding: str | None
    principles: frozenset[str]
    """Its family; of members that shared what they knew, also theirs and their method."""


def _parts(search: SearchResult, evidence: Evidence) -> list[Part]:
    row = _row(search, evidence)
    if not search.apart:
        best = math.inf if search.best is None else search.best.cost
        principles = _principles(search, family(search), shared=bool(search.members))
        return [Part(_titled(search), family(search), search.evaluations, best, row.basin, principles)]
    alone = {member.member for member in search.members if member.apart}
    return [
        Part(
            method(search.method, f"{search.title}: {a.title}"),
            *(a.family, a.evaluations, a.best, basin),
            _principles(search, a.family, shared=bool(search.members) and a.member not in alone),
        )
        for a, basin in zip(search.apart, row.apart, strict=True)
    ]


def _principles(search: SearchResult, leading: str, shared: bool) -> frozenset[str]:
    members = [member for member in search.members if shared and not member.apart]
    named = [member.family or member.member for member in members]
    return frozenset([leading, *named, *([search.method] if shared else [])])


def allowed(problem: Problem, nominal: float, worst: float) -> float:
    """The largest difference of costs that agree [the criterion's unit]. A worst case that violates has no margin that
    a disagreement could use up."""
    of_fall = min(problem.campaign.agreement, rules.AGREEMENT_AT_MOST.value) * (nominal - worst)
    margin = worst - problem.threshold
    least = rules.AGREEMENT_ROUNDING.value * max(abs(worst), abs(nominal), abs(problem.threshold))
    return max(min(of_fall, rules.AGREEMENT_OF_MARGIN.value * margin) if margin > 0 else of_fall, least)


def family(search: SearchResult) -> str:
    """The principle that found its best; earlier versions and undeclared methods count by name."""
    return search.family or search.method


def varies(evidence: Evidence, threshold: float) -> float:
    """The spread of the criterion over all stored evaluations; 0 if it is rounding, and small compared with the
    distance from the threshold."""
    spread = evidence.encounter.spread
    if spread.lowest is None or spread.highest is None:
        return 0.0
    by = spread.highest - spread.lowest
    size, margin = max(abs(spread.lowest), abs(spread.highest)), abs(spread.lowest - threshold)
    rounding = min(rules.ROUNDING.value * size, rules.AGREEMENT_OF_MARGIN.value * margin)
    return by if by > max(rounding, rules.AGREEMENT_ROUNDING.value * size) else 0.0


def _agreed(counted: Sequence[Part], evidence: Evidence, flat: bool, worst: float, nominal: float, unit: str) -> Check:
    reached = listed([part.title for part in counted])
    families = sorted({part.family for part in counted})
    pairs = combinations([part.principles for part in counted], rules.METHODS.value)
    confirmed = any(a.isdisjoint(b) for a, b in pairs)
    if not counted:
        return _check(False, "no part of a search that reached the worst case has enough evaluations to count as one")
    if not confirmed:
        shared = ", by principles that they share," if len(families) > 1 else ""
        of_one = shared or (f", of one family ({families[0]})," if len({part.title for part in counted}) > 1 else "")
        than = " than all of their members" if shared else ""
        second = f" reached the worst case; a method of another family{than} must confirm it"
        return _check(False, "only ", reached, of_one, second)
    if flat:
        evaluations = count(evidence.encounter.spread.evaluations, "evaluations")
        return _check(True, reached, " agree: the criterion does not vary over ", evaluations, " evaluations")
    if not worst < nominal:
        return _check(
            False,
            "no method found a value below the nominal case, so their agreement shows nothing; widen the bounds, or "
            "move the nominal values away from the worst case",
        )
    apart = max(part.best - worst for part in counted)
    labels = listed([finding(label) for label in sorted({str(part.finding) for part in counted})])
    return _check(True, reached, " agree on the worst case (", labels, ") within ", number(apart, unit, "apart"))


def _check(ok: bool, *statement: Said) -> Check:
    return check(CheckCode.AGREEMENT, ok, *statement)


def _titled(search: SearchResult) -> Span:
    return method(search.method, search.title)


def _not_searched(search: SearchResult, dimension: int) -> Spans:
    """Why a stage does not count as a search, as a sentence; empty if it does."""
    title, spent, least = _titled(search), search.evaluations, _least(search, dimension)
    if spent < least:
        many = " evaluation" if spent == 1 else " evaluations"
        ended = say(title, " ended after ", count(spent), many)
        return say(ended, "; at least ", count(least), " are required to count as a search")
    if rules.FAMILIES[search.kind].converges and (search.stop is None or search.stop.kind != "rule"):
        return say(title, " spent its budget before it converged")
    return ()


def _least(search: SearchResult, dimension: int) -> int:
    """The evaluations without which nothing was searched."""
    least = rules.FAMILIES[search.kind].least
    return dimension * (least.value if least is not None else 0)


def _stopped_short(search: SearchResult, worst: float, within: float, problem: Problem) -> Spans:
    if search.best is None:
        return say(_titled(search), " evaluated no case successfully")
    by = search.best.cost - worst
    return say(_titled(search), " stopped ", number(by, problem.unit), " above it") if by > within else ()


def _index(search: SearchResult, evidence: Evidence) -> int:
    return next(i for i, s in enumerate(evidence.searches) if s is search)


def _row(search: SearchResult, evidence: Evidence) -> Compared:
    return evidence.validation.comparison[_index(search, evidence)]
