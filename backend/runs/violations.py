"""Which runs speak against another one: they violate, found a value that would, or saw what bars "cleared" beyond
the horizon, with its question and its model.

A run does so with or without a verdict, as a cancelled one, a variant of a sweep, or one of a campaign with another
name, seed or budget: the case is there. One rule for requirements, sign-offs, reuse, reports and pages. Read `against`.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import sqlalchemy as sa

from backend.db.engine import chunks
from backend.db.rows import at_or_below, made_again_before, own_question, unread
from backend.db.tables import CampaignRow, Run, Stage
from backend.runs import identity
from campaigns.identity.identity import UNSTORED, Identity, may_equal
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState, run_name

CLOSER = "saw beyond the horizon what bars a cleared verdict"
"""Of runs of which validation saw a flight come closer there, or could not tell."""
MOST_NAMED = 3
"""Runs that a sentence names."""
LISTED = (Run.removed.is_(None), Run.purged.is_(None))
"""Removed runs speak against none: whoever removed one gave a reason."""


@dataclass(frozen=True)
class Found:
    """What one run asked and found. question: see `campaigns.checked.question`, empty if it is not stored; threshold
    and worst: of its criterion, and the lowest value of any evaluation [unit of the criterion]."""

    run_id: int
    campaign: str
    question: str
    verdict: VerdictWord | None
    identity: Identity
    threshold: float | None = None
    worst: float | None = None
    later: float | None = None
    """The lowest value beyond the horizon, see `Run.later`."""
    permits: bool = False
    """Whether its campaign, which it cleared, intends closest approaches at its end."""


def judged(state: str, word: str | None) -> VerdictWord | None:
    return None if word is None or state != RunState.DONE else VerdictWord(word)


def same_case(one: Found, other: Found) -> bool:
    """Whether both asked the same question of what may be the same model."""
    return one.question == other.question and may_equal(one.identity, other.identity)


def _lowest(one: Found) -> float:
    return math.inf if one.worst is None else one.worst


def at_threshold(one: Found, other: Found) -> bool:
    """Whether a run violates the threshold of another, or found a value that would."""
    if one.verdict == VerdictWord.VIOLATED and not above(one.threshold, other.threshold):
        return True
    return other.threshold is not None and _lowest(one) <= other.threshold


def comes_closer(other: Found, one: Found) -> bool:
    """Whether a run saw beyond the horizon what bars "cleared" of another one, which is cleared because it simulated
    others on: closer than any evaluation, or at or below the threshold where its campaign intends such approaches."""
    if other.later is None or one.verdict != VerdictWord.CLEARED:
        return False
    if one.permits:
        return one.threshold is not None and other.later <= one.threshold
    return other.later < _lowest(one)


def above(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and one > other


def found(reader: sa.Connection, *conditions: sa.ColumnElement[bool]) -> list[Found]:
    """What the runs found that fulfil the conditions; the lowest value is infinite without one."""
    lowest = sa.select(sa.func.min(Stage.best)).where(Stage.run_id == Run.id, own_question())
    worst = lowest.scalar_subquery().label("worst")
    columns = (Run.id, Run.state, Run.verdict, Run.threshold, Run.worst_cost, Run.made_again, Run.later, Run.question)
    of = sa.select(*columns, CampaignRow.name, worst, *identity.COLUMNS)
    of = of.join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    rows: Sequence[Any] = reader.execute(of.where(*conditions).order_by(Run.id)).all()
    if not rows:
        return []
    before = made_again_before(reader, [row.id for row in rows if row.made_again is None])
    stated = []
    for row in rows:
        values = [v for v in (row.worst_cost, before.get(row.id, row.made_again), row.worst) if v is not None]
        stated.append(
            Found(
                row.id,
                row.name,
                row.question or "",
                judged(row.state, row.verdict),
                identity.of_row(row) or UNSTORED,
                row.threshold,
                min(values, default=math.inf),
                row.later,
            )
        )
    return stated


def violating(reader: sa.Connection, limit: float, *conditions: sa.ColumnElement[bool]) -> list[Found]:
    """The listed runs among these that violate, found a value at or below the limit, or one beyond the horizon."""
    some = found(reader, *conditions, *LISTED, _seen(limit))
    return [o for o in some if o.verdict == VerdictWord.VIOLATED or o.later is not None or _lowest(o) <= limit]


def _seen(limit: float) -> sa.ColumnElement[bool]:
    return sa.or_(Run.verdict == VerdictWord.VIOLATED, at_or_below(limit), unread(), Run.later.is_not(None))


def _doubted(reader: sa.Connection, run_ids: Collection[int]) -> list[int]:
    """Of these the runs with a verdict that another run of their question may speak against. Most lists have none, and
    then nothing else is read."""
    own: list[Any] = []
    for some in chunks(run_ids):
        with_verdict = (Run.verdict.is_not(None), Run.verdict != VerdictWord.VIOLATED, Run.question.is_not(None))
        own += reader.execute(sa.select(Run.id, Run.question, Run.threshold).where(Run.id.in_(some), *with_verdict))
    limit = max((row.threshold for row in own if row.threshold is not None), default=-math.inf)
    seen: dict[str | None, set[int]] = defaultdict(set)
    for questions in chunks({row.question for row in own}):
        of = sa.select(Run.question, Run.id).where(Run.question.in_(questions), *LISTED, _seen(limit))
        for question, run_id in reader.execute(of):
            seen[question].add(run_id)
    return [row.id for row in own if seen[row.question] - {row.id}]


def against(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, list[Found]]:
    """The listed other runs that speak against the verdict of each, by run; none against one that violates. `later` is
    only of those that speak against it by nothing else."""
    own: list[Found] = []
    for some in chunks(_doubted(reader, run_ids)):
        own += found(reader, Run.id.in_(some))
    own = [one for one in own if one.verdict not in (None, VerdictWord.VIOLATED)]
    limit = max((one.threshold for one in own if one.threshold is not None), default=-math.inf)
    others: dict[str, list[Found]] = defaultdict(list)
    for some_questions in chunks({one.question for one in own}):
        for other in violating(reader, limit, Run.question.in_(some_questions)):
            others[other.question].append(other)
    permit = intending(reader, own, chain.from_iterable(others.values()))
    own = [replace(one, permits=one.run_id in permit) for one in own]
    return {run_id: speaking for run_id, speaking in _speaking(own, others) if speaking}


def intending(reader: sa.Connection, own: Iterable[Found], others: Iterable[Found]) -> set[int]:
    """Of cleared runs those with `permits`, which is read only where any of the others saw something beyond the
    horizon."""
    if all(one.later is None for one in others):
        return set()
    intends = CampaignRow.document["encounter", "intended", "closest_approach"].as_string().is_not(None)
    of = sa.select(Run.id).join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(intends)
    cleared = chunks({one.run_id for one in own if one.verdict == VerdictWord.CLEARED})
    return {run_id for some in cleared for run_id in reader.scalars(of.where(Run.id.in_(some)))}


def _speaking(own: Iterable[Found], others: Mapping[str, Sequence[Found]]) -> Iterator[tuple[int, list[Found]]]:
    """By run. Most runs of a list share question, threshold and identity, and thus one list, which may be long."""
    shared: dict[tuple[str, float | None, int], tuple[dict[int, Found], list[Found], list[Found]]] = {}
    for one in own:
        key = (one.question, one.threshold, id(one.identity))
        if key not in shared:
            low, later = _alike(one, others[one.question])
            shared[key] = low, [*low.values()], later
        low, speaking, later = shared[key]
        if one.run_id in low:
            speaking = [other for other in speaking if other.run_id != one.run_id]
        if closer := [other for other in later if other.run_id != one.run_id and comes_closer(other, one)]:
            speaking = sorted([*speaking, *closer], key=lambda other: other.run_id)
        yield one.run_id, speaking


def _alike(one: Found, others: Iterable[Found]) -> tuple[dict[int, Found], list[Found]]:
    """Of runs of its question those of what may be its model: that reach its threshold, by run, and others that saw
    something beyond the horizon."""
    equal: dict[int, bool] = {}
    low: dict[int, Found] = {}
    later: list[Found] = []
    for other in others:
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
    by: dict[str, list[int]] = defaultdict(list)
    for one in speaking:
        by[_way(one)].append(one.run_id)
    violated, lower, later = (by[way] for way in ("violates", "found", "beyond"))
    verb = "violates" if len(violated) == 1 else "violate"
    parts = [f"{named(violated)} {verb} the criterion"] if violated else []
    parts += [f"{named(lower)} found a value at or below the threshold"] if lower else []
    parts += [f"{named(later)} {CLOSER}"] if later else []
    return f"{' and '.join(parts)}, on the same question and model"


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
