"""Which runs speak against another one: they violate, found a value that would, or saw what bars "cleared" beyond
the horizon, within its question and on its model.

A run does so with or without a verdict, as a cancelled one, a variant of a sweep, or one of a campaign with another
name, seed, budget or other bounds around the case: the case is there. One rule for requirements, sign-offs, reuse,
reports and pages. Read `against`.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sqlalchemy as sa

from backend.db.engine import chunks, once
from backend.db.questions import alike
from backend.db.rows import at_or_below, unread
from backend.db.tables import CampaignRow, Run
from backend.runs.within import Found, found, in_question, located, of_runs
from campaigns.identity.identity import may_equal
from campaigns.results.verdict import VerdictWord
from campaigns.runs import run_name

CLOSER = "saw beyond the horizon what bars a cleared verdict"
"""Of runs of which validation saw a flight come closer there, or could not tell."""
SAME, WITHIN = "on the same question and model", "in a case within these bounds, on the same model"
"""Where a run found what speaks against another one."""
MOST_NAMED = 3
"""Runs that a sentence names."""
LISTED = (Run.removed.is_(None), Run.purged.is_(None))
"""Removed runs speak against none: whoever removed one gave a reason."""


def at_threshold(one: Found, other: Found) -> bool:
    """Whether a run violates the threshold of another, or found a value that would."""
    if one.verdict == VerdictWord.VIOLATED and not above(one.threshold, other.threshold):
        return True
    return other.threshold is not None and one.lowest <= other.threshold


def comes_closer(other: Found, one: Found) -> bool:
    """Whether a run saw beyond the horizon what bars "cleared" of another one, which is cleared because it simulated
    others on: closer than any evaluation, or at or below the threshold where its campaign intends such approaches."""
    if other.later is None or one.verdict != VerdictWord.CLEARED:
        return False
    if one.permits:
        return one.threshold is not None and other.later <= one.threshold
    return other.later < one.lowest


def above(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and one > other


def violating(reader: sa.Connection, limit: float, *conditions: sa.ColumnElement[bool]) -> list[Found]:
    """The listed runs among these that violate, found a value at or below the limit, or one beyond the horizon."""
    some = found(reader, *conditions, *LISTED, _seen(limit))
    return [o for o in some if o.verdict == VerdictWord.VIOLATED or o.later is not None or o.lowest <= limit]


def _seen(limit: float) -> sa.ColumnElement[bool]:
    return sa.or_(Run.verdict == VerdictWord.VIOLATED, at_or_below(limit), unread(), Run.later.is_not(None))


def against(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, list[Found]]:
    """The listed other runs that speak against the verdict of each, by run; none against one that violates. `later` is
    only of those that speak against it by nothing else."""
    known = once(reader, "against", dict[int, list[Found]])
    if new := set(run_ids) - known.keys():
        compared = _compared(reader, new)
        known |= {run_id: compared.get(run_id, []) for run_id in new}
    return {run_id: known[run_id] for run_id in sorted(set(run_ids)) if known[run_id]}


def _compared(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, list[Found]]:
    asking = _with_verdict(reader, run_ids)
    kins = alike(reader, {row.question for row in asking})
    limit = max((row.threshold for row in asking if row.threshold is not None), default=-math.inf)
    seen = _seen_within(reader, kins, limit)  # of most lists none, and then nothing else is read
    doubted = [row.id for row in asking if any(run_id != row.id for run_id in seen[kins[row.question]])]
    own = [one for one in of_runs(reader, doubted) if one.verdict not in (None, VerdictWord.VIOLATED)]
    own = [one for one in own if one.question in kins]  # a worker may have stored another one since
    every = of_runs(reader, {run_id for kin in {kins[one.question] for one in own} for run_id in seen[kin]})
    permit = intending(reader, own, every)
    own = [replace(one, permits=one.run_id in permit) for one in own]
    both = located(reader, [*own, *every])
    others: dict[str, list[Found]] = defaultdict(list)
    for other in both[len(own) :]:
        others[kins.get(other.question, "")].append(other)
    return {run_id: speaking for run_id, speaking in _speaking(both[: len(own)], others, kins) if speaking}


def _with_verdict(reader: sa.Connection, run_ids: Collection[int]) -> list[Any]:
    """Number, question and threshold of those of these that have a verdict which another run may speak against."""
    may = (Run.verdict.is_not(None), Run.verdict != VerdictWord.VIOLATED, Run.question.is_not(None))
    of = sa.select(Run.id, Run.question, Run.threshold).where(*may)
    return [row for some in chunks(run_ids) for row in reader.execute(of.where(Run.id.in_(some)))]


def _seen_within(reader: sa.Connection, kins: Mapping[str, str], limit: float) -> dict[str, set[int]]:
    """The listed runs that may speak against one with this threshold, by what their questions have in common."""
    seen: dict[str, set[int]] = defaultdict(set)
    for some in chunks(kins):
        of = sa.select(Run.question, Run.id).where(Run.question.in_(some), *LISTED, _seen(limit))
        for question, run_id in reader.execute(of):
            seen[kins[question or ""]].add(run_id)
    return seen


def intending(reader: sa.Connection, own: Iterable[Found], others: Iterable[Found]) -> set[int]:
    """Of cleared runs those with `permits`, which is read only where any of the others saw something beyond the
    horizon."""
    if all(one.later is None for one in others):
        return set()
    intends = CampaignRow.document["encounter", "intended", "closest_approach"].as_string().is_not(None)
    of = sa.select(Run.id).join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(intends)
    cleared = chunks({one.run_id for one in own if one.verdict == VerdictWord.CLEARED})
    return {run_id for some in cleared for run_id in reader.scalars(of.where(Run.id.in_(some)))}


def _speaking(
    own: Iterable[Found], others: Mapping[str, Sequence[Found]], kins: Mapping[str, str]
) -> Iterator[tuple[int, list[Found]]]:
    """By run. Most runs of a list share question, threshold and identity, and thus one list, which may be long."""
    shared: dict[tuple[str, str, float | None, int], tuple[dict[int, Found], list[Found], list[Found]]] = {}
    for one in own:
        key = (one.question, one.bounds, one.threshold, id(one.identity))
        if key not in shared:
            low, later = _alike(one, others[kins[one.question]])
            shared[key] = low, [*low.values()], later
        low, speaking, later = shared[key]
        if one.run_id in low:
            speaking = [other for other in speaking if other.run_id != one.run_id]
        if closer := [other for other in later if other.run_id != one.run_id and comes_closer(other, one)]:
            speaking = sorted([*speaking, *closer], key=lambda other: other.run_id)
        yield one.run_id, speaking


def _alike(one: Found, others: Iterable[Found]) -> tuple[dict[int, Found], list[Found]]:
    """Of what other runs found within its question that of what may be its model: of those that reach its threshold,
    by run, and of others that saw something beyond the horizon."""
    equal: dict[int, bool] = {}
    low: dict[int, Found] = {}
    later: list[Found] = []
    for other in (seen for other in others if (seen := in_question(other, one)) is not None):
        reaches, model = at_threshold(other, one), id(other.identity)
        if not reaches and other.later is None:
            continue
        if model not in equal:
            equal[model] = may_equal(other.identity, one.identity)
        if equal[model] and reaches:
            low[other.run_id] = other if other.later is None else replace(other, later=None)
        elif equal[model]:
            later.append(other)
    return low, later


def clause(speaking: Sequence[Found]) -> str:
    """That these speak against a run, for a sentence on it."""
    same = [one for one in speaking if not one.inside]
    inside = [one for one in speaking if one.inside]
    parts = [f"{_clause(same)}, {SAME}"] if same else []
    parts += [f"{_clause(inside)}, {WITHIN}"] if inside else []
    return "; ".join(parts)


def _clause(speaking: Sequence[Found]) -> str:
    by: dict[str, list[int]] = defaultdict(list)
    for one in speaking:
        by[_way(one)].append(one.run_id)
    violated, lower, later = (by[way] for way in ("violates", "found", "beyond"))
    verb = "violates" if len(violated) == 1 else "violate"
    parts = [f"{named(violated)} {verb} the criterion"] if violated else []
    parts += [f"{named(lower)} found a value at or below the threshold"] if lower else []
    parts += [f"{named(later)} {CLOSER}"] if later else []
    return " and ".join(parts)


def ways(speaking: Iterable[Found]) -> dict[str, str]:
    """How each of these speaks against a run: what a sign-off in its knowledge is bound to."""
    return {run_name(one.run_id): _way(one) for one in speaking}


def _way(one: Found) -> str:
    if one.later is not None:  # also of one that violates a higher threshold only
        return "beyond"
    return "violates" if one.verdict == VerdictWord.VIOLATED else "found"


def sentence_of(reader: sa.Connection, run_id: int) -> str:
    """What speaks against the verdict of one run; empty if nothing does."""
    return sentences(reader, [run_id]).get(run_id, "")


def sentences(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, str]:
    """The same of each of these, by run, without those that nothing speaks against."""
    stated = against(reader, run_ids)
    clauses = {id(speaking): clause(speaking) for speaking in {id(some): some for some in stated.values()}.values()}
    return {run_id: f"{clauses[id(speaking)]}." for run_id, speaking in stated.items()}


def named(runs: Sequence[int]) -> str:
    rest = len(runs) - MOST_NAMED
    return ", ".join(map(run_name, runs[:MOST_NAMED])) + (f" and {rest} more" if rest > 0 else "")
