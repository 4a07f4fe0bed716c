"""The filters of the run list, from a query, and as SQL conditions."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import sqlalchemy as sa
from fastapi import Query
from pydantic import Field
from sqlalchemy.ext.compiler import compiles

from backend.db import labels
from backend.db.tables import CampaignRow, Run
from backend.http.errors import RefusedError
from backend.http.schema import Finite
from backend.runs.order import NEWEST, Sort
from campaigns import Problem
from campaigns.labels import pair
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState

MOST = 50
"""Alternative values of one filter."""
MOST_WORDS = 8
"""Maximum number of search words; further ones are ignored."""
_IN_ID = re.compile("r|(r?-)?[0-9]*", re.IGNORECASE)
"""The words that a printed number such as R-0001 can contain."""
Word = Annotated[str, Field(max_length=200)]


@dataclass(frozen=True)
class Filters:
    """The filters of the list, as a query has them; lists are alternatives, an empty list does not filter."""

    q: Annotated[str, Query(max_length=200, description="Words in the name, campaign, tags, owner or number.")] = ""
    state: Annotated[list[RunState] | None, Query(max_length=MOST, description="Their states.")] = None
    verdict: Annotated[list[VerdictWord] | None, Query(max_length=MOST, description="Their verdicts.")] = None
    tag: Annotated[list[Word] | None, Query(max_length=MOST, description="Tags; a run must have one of them.")] = None
    campaign: Annotated[list[Word] | None, Query(max_length=MOST, description="Names of campaigns.")] = None
    owner: Annotated[list[Word] | None, Query(max_length=MOST, description="Users or tokens that submitted.")] = None
    """Users, with the runs of their tokens, or names of tokens."""
    method: Annotated[
        list[Word] | None,
        Query(max_length=MOST, description="Methods that found the worst case."),
    ] = None
    since: Annotated[Finite | None, Query(description="Submitted since this time [s since 1970].")] = None
    until: Annotated[Finite | None, Query(description="Submitted before this time [s since 1970].")] = None
    pinned: Annotated[bool | None, Query(description="Only pinned runs, or only the others.")] = None
    label: Annotated[
        list[Word] | None,
        Query(max_length=MOST, description="Labels as KEY=VALUE: alternatives of one key, every key required."),
    ] = None
    removed: Annotated[bool, Query(description="Removed runs instead of listed ones.")] = False

    def conditions(self) -> list[sa.ColumnElement[bool]]:
        found = [*self.there(), *self.narrowed]
        if self.state:
            found.append(unindexed(Run.state).in_(self.state))
        if self.verdict:
            found.append(Run.verdict.in_(self.verdict))
        return found

    @cached_property
    def narrowed(self) -> list[sa.ColumnElement[bool]]:
        """All conditions except state and verdict, by which the result is counted, for removed and listed runs; made
        once, because that takes longer than reading a row."""
        conditions = [_contains(word) for word in self.q.split()[:MOST_WORDS]]
        if self.tag:
            tags = sa.cast(Run.tags, sa.Text)
            conditions.append(sa.or_(*(tags.contains(json.dumps(tag), autoescape=True) for tag in self.tag)))
        conditions += labels.conditions(labelled(self.label or ()))
        if self.campaign:
            named = sa.select(CampaignRow.digest).where(CampaignRow.name.in_(self.campaign))
            conditions.append(unindexed(Run.campaign_digest).in_(named))
        if self.owner:
            conditions.append(sa.or_(Run.owner.in_(self.owner), Run.token.in_(self.owner)))
        if self.method:
            conditions.append(Run.worst_method.in_(self.method))
        if self.since is not None:
            conditions.append(unindexed(Run.created, 0.0) >= self.since)
        if self.until is not None:
            conditions.append(unindexed(Run.created, 0.0) < self.until)
        if self.pinned is not None:
            conditions.append(Run.pinned == self.pinned)
        return conditions

    def there(self, removed: bool | None = None) -> list[sa.ColumnElement[bool]]:
        """Listed, or removed but not purged."""
        if self.removed if removed is None else removed:
            return [Run.removed.is_not(None), Run.purged.is_(None)]
        return [Run.removed.is_(None)]


@dataclass(frozen=True)
class Listed(Filters):
    """The filters of the list, its order, and the page of it."""

    sort: Annotated[Sort, Query(description="With a minus: largest first.")] = NEWEST
    cursor: Annotated[str | None, Query(max_length=1000, description="`next_cursor` of the previous page.")] = None
    limit: Annotated[int, Query(ge=1, le=200, description="Maximum number of runs on a page.")] = 50


def labelled(texts: Sequence[str]) -> list[tuple[str, str]]:
    """Keys and values of labels; 422 with a sentence for anything else."""
    try:
        return [pair(text) for text in texts]
    except ValueError as error:
        raise RefusedError("invalid-request", f"{error}", [Problem("label", "", f"{error}")]) from None


def unindexed(column: Any, empty: Any = "") -> sa.ColumnElement[Any]:
    """A column as an expression, for which no index is used but that of the list: SQLite has no statistics, prefers
    any index on the column itself, and then reads the wide row of every run in it. Missing values are empty."""
    return sa.func.coalesce(sa.type_coerce(column, sa.String) if empty == "" else column, empty)


class _Folded(sa.sql.functions.GenericFunction[str]):
    """Text in which LIKE ignores case: that of SQLite does so for the letters that its `lower` changes, in a third of
    the time."""

    name = "lower"
    type = sa.String()
    inherit_cache = True


@compiles(_Folded, "sqlite")
def _plain(element: _Folded, compiler: Any, **options: Any) -> str:
    return str(compiler.process(element.clauses, **options))


def _contains(word: str) -> sa.ColumnElement[bool]:
    escaped = word.replace("/", "//").replace("%", "/%").replace("_", "/_")
    pattern = _Folded(sa.literal(f"%{escaped}%"))
    columns = [Run.name, Run.owner, Run.token, sa.cast(Run.tags, sa.Text)]
    if _IN_ID.fullmatch(word):
        columns.append(_printed_id())
    named = sa.select(CampaignRow.digest).where(_Folded(CampaignRow.name).like(pattern, escape="/"))
    here = [_Folded(column).like(pattern, escape="/") for column in columns]
    return sa.or_(*here, unindexed(Run.campaign_digest).in_(named))


def _printed_id() -> sa.ColumnElement[str]:
    digits = sa.cast(Run.id, sa.String)
    padded = sa.func.substr("0000" + digits, sa.func.length(digits) + 1)
    return "R-" + sa.case((Run.id < 10_000, padded), else_=digits)
