"""What runs found: their values, within which bounds, and what of it lies within the question of another run.

Read `located` and `within`; which of it speaks against that run is in `violations`.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import sqlalchemy as sa
from pydantic import ValidationError

from backend.db.engine import chunks
from backend.db.questions import boxes
from backend.db.rows import made_again_before, own_question
from backend.db.tables import CampaignRow, Finding, Run, Stage
from backend.runs import identity
from campaigns.checked.box import Box
from campaigns.identity.identity import UNSTORED, Identity, may_equal
from campaigns.results.finding import Validation, violates
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState


@dataclass(frozen=True)
class Case:
    """One worst case of a run: its box, the lowest value that it was seen to have, whether it is a confirmed
    violation."""

    box: Box
    worst: float
    violates: bool


@dataclass(frozen=True)
class Found:
    """What one run asked and found. question and bounds: see `campaigns.checked.question`, empty if they are not
    stored; threshold and worst: of its criterion, and the lowest value of any evaluation [unit of the criterion]."""

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
    bounds: str = ""
    box: Box | None = None
    """Of its question; not read where no other run of a list asks the same within other bounds. See `located`."""
    cases: tuple[Case, ...] = ()
    inside: bool = False
    """Whether this is what it found inside the bounds of another run, which has others."""

    @property
    def lowest(self) -> float:
        return math.inf if self.worst is None else self.worst


Some = TypeVar("Some", bound=Found)


def judged(state: str, word: str | None) -> VerdictWord | None:
    return None if word is None or state != RunState.DONE else VerdictWord(word)


def found(reader: sa.Connection, *conditions: sa.ColumnElement[bool]) -> list[Found]:
    """What the runs found that fulfil the conditions; the lowest value is infinite without one."""
    lowest = sa.select(sa.func.min(Stage.best)).where(Stage.run_id == Run.id, own_question())
    worst = lowest.scalar_subquery().label("worst")
    columns = (Run.id, Run.state, Run.verdict, Run.threshold, Run.worst_cost, Run.made_again, Run.later)
    of = sa.select(*columns, Run.question, Run.bounds, CampaignRow.name, worst, *identity.COLUMNS)
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
                bounds=row.bounds or "",
            )
        )
    return stated


def of_runs(reader: sa.Connection, run_ids: Collection[int]) -> list[Found]:
    """The same of these runs."""
    return [one for some in chunks(run_ids) for one in found(reader, Run.id.in_(some))]


def within(other: Some, one: Found) -> Some | None:
    """What another run found within the question of this one, of what may be its model; None if there is nothing."""
    seen = in_question(other, one)
    return seen if seen is not None and may_equal(other.identity, one.identity) else None


def in_question(other: Some, one: Found) -> Some | None:
    """What another run found within the question of this one: all, if its bounds are inside, else its cases there."""
    if other.question == one.question:
        return other
    if other.box is None or one.box is None or other.box.apart(one.box):
        return None
    if other.box.inside(one.box):
        return replace(other, inside=True)
    cases = [case for case in other.cases if case.box.inside(one.box)]
    if not cases:
        return None
    word = other.verdict if any(case.violates for case in cases) else None
    worst = min(case.worst for case in cases)
    return replace(other, verdict=word, worst=worst, later=None, inside=True)


def located(reader: sa.Connection, some: Sequence[Some]) -> list[Some]:
    """These with their boxes and their cases, if others of them ask the same within other bounds."""
    of = boxes(reader, {one.bounds for one in some if one.bounds})
    kins = Counter(kin for kin, _ in {(box.kin, question) for (question, _), box in of.items()})
    own = {one.run_id: of.get((one.question, one.bounds)) for one in some}
    apart = {run_id: box for run_id, box in own.items() if box is not None and kins[box.kin] > 1}
    limit = max((one.threshold for one in some if one.threshold is not None), default=-math.inf)
    speaking = {one.run_id for one in some if one.verdict == VerdictWord.VIOLATED or one.lowest <= limit}
    cases = _cases(reader, {run_id: box for run_id, box in apart.items() if run_id in speaking})
    return [
        replace(one, box=apart[one.run_id], cases=cases.get(one.run_id, ())) if one.run_id in apart else one
        for one in some
    ]


def _cases(reader: sa.Connection, run_boxes: Mapping[int, Box]) -> dict[int, tuple[Case, ...]]:
    """The worst cases of these runs, by run."""
    found: dict[int, list[Case]] = defaultdict(list)
    columns = (Finding.run_id, Finding.cost, Finding.margin, Finding.parameters, Finding.validation)
    for some in chunks(run_boxes):
        for row in reader.execute(sa.select(*columns).where(Finding.run_id.in_(some)).order_by(Finding.label)):
            with suppress(ValidationError):  # of another version, whose cases are unknown here
                case = None if row.validation is None else Validation.model_validate(row.validation)
                worst = min([row.cost, *(() if case is None else case.values)])
                where = run_boxes[row.run_id].at(row.parameters)
                found[row.run_id].append(Case(where, worst, violates(row.margin, case)))
    return {run_id: tuple(cases) for run_id, cases in found.items()}
