"""What speaks against evidence besides its own run: other runs of the campaign, removed runs, ids that look the same.

A value below the threshold was found, whoever found it: a cancelled run, one of a sweep, one whose campaign does not
state the requirement.
"""

from __future__ import annotations

import math
import unicodedata
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from backend.db.engine import chunks
from backend.db.purge import violates
from backend.db.rows import made_again_before, own_question
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run, RunRequirement, Stage
from backend.requirements.standing import Edge
from backend.runs import identity
from campaigns.alike import plain
from campaigns.identity.identity import UNSTORED
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState, run_name

MOST_NAMED = 20
"""Runs or ids that a sentence names."""


def judged(state: str, word: str | None) -> VerdictWord | None:
    return None if word is None or state != RunState.DONE else VerdictWord(word)


def against(reader: sa.Connection, edges: Mapping[str, Sequence[Edge]]) -> list[Edge]:
    """All other runs of the campaigns of these names that violate, or found a value that would violate one of these.

    They need not state the requirement, and may be cancelled, or of a sweep: the value was found all the same. The
    questions of `edges` decide which of them count, see `standing`.
    """
    highest: dict[str, float] = {}
    for edge in (e for found in edges.values() for e in found):
        threshold = -math.inf if edge.threshold is None else edge.threshold
        highest[edge.campaign] = max(highest.get(edge.campaign, -math.inf), threshold)
    lowest = sa.select(sa.func.min(Stage.best)).where(Stage.run_id == Run.id, own_question())
    worst = lowest.scalar_subquery().label("worst")
    columns = (Run.id, Run.state, Run.verdict, Run.threshold, Run.worst_cost, Run.made_again, Run.question)
    rows: list[Any] = []
    for some in chunks(highest):
        of = sa.select(*columns, CampaignRow.name, worst).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        of = of.where(CampaignRow.name.in_(some), Run.removed.is_(None), Run.purged.is_(None))
        rows += reader.execute(of)
    found, before = [], made_again_before(reader, [row.id for row in rows if row.made_again is None])
    for row in rows:
        again = before.get(row.id, row.made_again)
        values = [value for value in (row.worst_cost, again, row.worst) if value is not None]
        value = min(values, default=math.inf)
        if judged(row.state, row.verdict) == VerdictWord.VIOLATED or value <= highest[row.name]:
            found.append((row, value))
    known = identity.of_runs(reader, [row.id for row, _ in found])
    return [
        Edge(
            row.id,
            row.name,
            row.question or "",
            judged(row.state, row.verdict),
            known.get(row.id, UNSTORED),
            threshold=row.threshold,
            worst=value,
        )
        for row, value in found
    ]


@dataclass(frozen=True)
class Ignored:
    removed: int = 0
    sweeps: int = 0
    violated: tuple[int, ...] = ()
    """The removed ones that violated it, also those that asked the same without stating it."""
    found: tuple[int, ...] = ()
    """Those that found a value at or below a threshold of that question, without a verdict that confirms it."""


def ignored(reader: sa.Connection, ids: Sequence[str]) -> dict[str, Ignored]:
    gone = sa.or_(Run.removed.is_not(None), Run.purged.is_not(None))
    columns = (RunRequirement.requirement, Run.id, gone.label("gone"))
    of = sa.select(*columns).join(Run, Run.id == RunRequirement.run_id)
    of = of.where(RunRequirement.requirement.in_(ids), sa.or_(gone, in_sweep())).order_by(Run.id)
    found: dict[str, Ignored] = defaultdict(Ignored)
    for row in reader.execute(of):
        now = found[row.requirement]
        found[row.requirement] = replace(now, removed=now.removed + row.gone, sweeps=now.sweeps + (not row.gone))
    asking = orm.aliased(Run)
    asks = sa.select(RunRequirement.requirement, Run.id, Run.state, Run.verdict).distinct()
    asks = asks.join(asking, asking.id == RunRequirement.run_id)
    asks = asks.join(Run, Run.question == asking.question).where(gone, violates())
    for key, run_id, state, word in reader.execute(asks.where(RunRequirement.requirement.in_(ids)).order_by(Run.id)):
        now = found[key]
        if judged(state, word) == VerdictWord.VIOLATED:
            found[key] = replace(now, violated=(*now.violated, run_id))
        else:
            found[key] = replace(now, found=(*now.found, run_id))
    return found


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


def _named(runs: Sequence[int]) -> str:
    rest = len(runs) - MOST_NAMED
    return ", ".join(map(run_name, runs[:MOST_NAMED])) + (f" and {rest} more" if rest > 0 else "")


def notes(ignored: Ignored, similar: Sequence[str]) -> Iterator[str]:
    """Further notes for a reader of the status: exports have them as well."""
    spoke = {"violated it": ignored.violated, "found a value at or below a threshold of that question": ignored.found}
    if clauses := [f"{_named(runs)} {what}" for what, runs in spoke.items() if runs]:
        yield f"Removed runs do not count; of those that asked the same, {', and '.join(clauses)}."
    if similar:
        others = ", ".join(map(repr, similar[:MOST_NAMED]))
        yield f"Other ids differ only in case, spaces or the form of characters: {others}."
