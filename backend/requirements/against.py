"""What speaks against evidence besides its own run: other runs of the campaign, removed runs, ids that look the same.

A value below the threshold was found, whoever found it: a cancelled run, one of a sweep, one whose campaign does not
state the requirement.
"""

from __future__ import annotations

import math
import unicodedata
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import chain
from typing import Any

import sqlalchemy as sa

from backend.db.engine import chunks
from backend.db.purge import violates
from backend.db.questions import alike
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run, RunRequirement
from backend.requirements.standing import EARLIER, Edge, How, how, newest_of
from backend.runs.violations import CLOSER, intending, named, violating
from backend.runs.within import Found, in_question, of_runs
from backend.runs.within import located as located_among
from campaigns.alike import plain


def against(reader: sa.Connection, edges: Mapping[str, Sequence[Edge]]) -> list[Edge]:
    """All other runs that ask the same, perhaps within other bounds, and violate, or found a value that would violate
    one of these.

    They need not state the requirement, and may be cancelled, of a sweep, or of a campaign of another name: the value
    was found all the same. A run whose question is not stored can only speak against its own campaign. Which of them
    count, `standing` decides.
    """
    every = [e for found in edges.values() for e in found]
    limit = max((e.threshold for e in every if e.threshold is not None), default=-math.inf)
    others: list[Edge] = []
    for some in chunks(alike(reader, {e.question for e in every if e.question})):
        others += as_edges(violating(reader, limit, Run.question.in_(some)))
    for some in chunks({e.campaign for e in every if not e.question}):
        others += as_edges(violating(reader, limit, Run.question.is_(None), CampaignRow.name.in_(some)))
    return others


def as_edges(some: Iterable[Found]) -> list[Edge]:
    """What runs found, without what a requirement states of them."""
    return [Edge(**vars(one)) for one in some]


def located(
    reader: sa.Connection, edges: Mapping[str, Sequence[Edge]], others: Sequence[Edge]
) -> tuple[dict[str, list[Edge]], list[Edge]]:
    """Both with what tells which of the others speak against the edges: intents, and bounds within those of others."""
    own = [*chain.from_iterable(edges.values())]
    permit = intending(reader, own, others)
    every = located_among(reader, [*(replace(e, permits=e.run_id in permit) for e in own), *others])
    rest = iter(every)
    return {key: [next(rest) for _ in found] for key, found in edges.items()}, [*rest]


MOST_SIMILAR = 20
"""Ids that a note names."""


@dataclass(frozen=True)
class Ignored:
    removed: int = 0
    sweeps: int = 0
    spoke: Mapping[How, Sequence[int]] = field(default_factory=dict)
    """The removed runs that speak against it, also those that asked the same without stating it."""


def ignored(reader: sa.Connection, ids: Sequence[str], edges: Mapping[str, Sequence[Edge]]) -> Mapping[str, Ignored]:
    """What does not count for each requirement. edges: the runs that do."""
    gone = sa.or_(Run.removed.is_not(None), Run.purged.is_not(None))
    swept = in_sweep()
    columns = (RunRequirement.requirement, Run.id, gone.label("gone"), swept.label("swept"))
    of = sa.select(*columns).join(Run, Run.id == RunRequirement.run_id)
    of = of.where(RunRequirement.requirement.in_(ids), sa.or_(gone, swept)).order_by(Run.id)
    found: dict[str, Ignored] = defaultdict(Ignored)
    stating: dict[str, set[int]] = defaultdict(set)
    for row in reader.execute(of):
        now = found[row.requirement]
        found[row.requirement] = replace(now, removed=now.removed + row.gone, sweeps=now.sweeps + (not row.gone))
        if row.gone and not row.swept:
            stating[row.requirement].add(row.id)
    asking = _asking(reader, ids)
    if not (speaking := _speaking(reader, ids, gone, asking)):
        return found
    removed = as_edges(of_runs(reader, {*chain(*speaking.values(), *(stating[key] for key in speaking))}))
    edges, rest = located(reader, edges, removed)
    by = {edge.run_id: edge for edge in rest}
    for key, runs in speaking.items():
        own = [by[run_id] for run_id in stating[key]]
        spoke = _spoke([by[run_id] for run_id in sorted(runs)], own, edges.get(key, ()), asking[key])
        found[key] = replace(found[key], spoke=spoke)
    return found


def _asking(reader: sa.Connection, ids: Sequence[str]) -> dict[str, set[str]]:
    """The questions of the runs that state each requirement, removed ones included."""
    of = sa.select(RunRequirement.requirement, Run.question).join(Run, Run.id == RunRequirement.run_id)
    found: dict[str, set[str]] = defaultdict(set)
    for key, question in reader.execute(of.where(RunRequirement.requirement.in_(ids)).distinct()):
        found[key].add(question or "")
    return found


def _speaking(
    reader: sa.Connection, ids: Sequence[str], gone: sa.ColumnElement[bool], asking: Mapping[str, set[str]]
) -> dict[str, set[int]]:
    """The removed runs by requirement that may speak against it, and state it or ask what a run that states it asks,
    perhaps within other bounds."""
    may = sa.or_(violates(), Run.later.is_not(None))
    states = sa.select(RunRequirement.requirement, Run.id).join(Run, Run.id == RunRequirement.run_id)
    states = states.where(RunRequirement.requirement.in_(ids))
    found: dict[str, set[int]] = defaultdict(set)
    for key, run_id in reader.execute(states.where(gone, may)):
        found[key].add(run_id)
    kins = alike(reader, {question for questions in asking.values() for question in questions if question})
    keys: dict[str, set[str]] = defaultdict(set)
    for key, questions in asking.items():
        for question in questions - {""}:  # without one it equals none
            keys[kins[question]].add(key)
    for alike_ones in chunks(kins):
        of = sa.select(Run.question, Run.id).where(Run.question.in_(alike_ones), gone, may)
        for asks, run_id in reader.execute(of):
            for key in keys[kins[asks or ""]]:
                found[key].add(run_id)
    return found


def _spoke(
    removed: Sequence[Edge], stating: Sequence[Edge], edges: Sequence[Edge], asking: Collection[str]
) -> dict[How, list[int]]:
    """How removed runs speak against the evidence of a requirement, by the rule for runs that count.

    stating: those of the removed ones that state it and are of no sweep; edges: the runs that count. If none of
    these is like it, a removed run is compared with the newest removed one. asking: the questions of all that state it.
    """
    own = {edge.run_id for edge in stating}
    counting, gone = _newest(edges), _newest(stating)
    spoke: dict[How, list[int]] = {}
    for edge in removed:
        alone = [edge] if edge.question in asking else []
        ways = {_way(edge, one, edge.run_id in own) for one in _like(edge, counting) or _like(edge, gone) or alone}
        if known := [way for way in REMOVED if way in ways]:
            spoke.setdefault(known[0], []).append(edge.run_id)
    return spoke


def _newest(edges: Sequence[Edge]) -> list[Edge]:
    """The newest evidence of each campaign."""
    by_name: dict[str, list[Edge]] = defaultdict(list)
    for edge in edges:
        by_name[edge.campaign].append(edge)
    return [newest_of(found) for found in by_name.values()]


def _like(edge: Edge, newest: Sequence[Edge]) -> list[Edge]:
    """Those of the campaign of that name, or whose question it speaks of."""
    return [e for e in newest if e.campaign == edge.campaign or in_question(edge, e) is not None]


def _way(edge: Edge, newest: Edge, states: bool) -> How | None:
    """As `how`; a run that does not state the requirement says nothing on how that was lowered, or stated before."""
    way = how(edge, newest)
    if states:
        return way
    return "higher" if way == "lowered" else None if way in ("before", "other") else way


@lru_cache(maxsize=50_000)
def _fold(key: str) -> str:
    """Equal for ids that a reader would take for the same."""
    return "".join("".join("-" if unicodedata.category(c) == "Pd" else c for c in plain(key)).split())


def similar(reader: sa.Connection, ids: Sequence[str], every: sa.CompoundSelect[Any]) -> dict[str, list[str]]:
    """The other ids that differ from each only in case, spaces or the form of characters."""
    wanted: dict[str, list[str]] = {_fold(key): [] for key in ids}
    for key in reader.scalars(every):
        if (folded := _fold(key)) in wanted:
            wanted[folded].append(key)
    return {key: [one for one in wanted[_fold(key)] if one != key] for key in ids}


REMOVED: dict[How, str] = {
    "violated": "of those that asked the same, {} violated it",
    "found": "of those that asked the same, {} found a value at or below the newest threshold",
    "closer": f"of those that asked the same, {{}} {CLOSER}",
    **EARLIER,
    "higher": "at a higher threshold, {} violated it",
    "found higher": "at a higher threshold, {} found a value at or below it",
    "other": "another campaign of that name or another model violated it: {}",
}
"""How removed runs speak against a requirement, the worst first."""


def notes(ignored: Ignored, similar: Sequence[str]) -> Iterator[str]:
    """Further notes for a reader of the status: exports have them as well."""
    spoke = ignored.spoke
    if clauses := [text.format(named(spoke[way])) for way, text in REMOVED.items() if way in spoke]:
        yield f"Removed runs do not count; {'; '.join(clauses)}."
    if similar:
        others = ", ".join(map(repr, similar[:MOST_SIMILAR]))
        yield f"Other ids differ only in case, spaces or the form of characters: {others}."
