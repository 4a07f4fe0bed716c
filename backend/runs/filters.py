"""The filters of the run list, as SQL conditions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db import labels
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run
from backend.http.errors import RefusedError
from campaigns import Problem
from campaigns.labels import pair
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState

MOST_WORDS = 8
"""Maximum number of search words; further ones are ignored."""


@dataclass(frozen=True)
class Filters:
    """The filters of the list; lists are alternatives, an empty list does not filter. Times [s since 1970]."""

    q: str = ""
    state: Sequence[RunState] = ()
    verdict: Sequence[VerdictWord] = ()
    tag: Sequence[str] = ()
    campaign: Sequence[str] = ()
    """Names of campaigns."""
    owner: Sequence[str] = ()
    """Users, with the runs of their tokens, or names of tokens."""
    method: Sequence[str] = ()
    """Methods that found the worst case."""
    since: float | None = None
    until: float | None = None
    """Submitted from `since` on, and before `until`."""
    pinned: bool | None = None
    removed: bool = False
    """Removed runs instead of listed ones."""
    label: Sequence[tuple[str, str]] = ()
    """Keys and values: alternatives of the same key, every key required."""

    def conditions(self) -> list[sa.ColumnElement[bool]]:
        found = self.found()
        if self.state:
            found.append(Run.state.in_(self.state))
        if self.verdict:
            found.append(Run.verdict.in_(self.verdict))
        return found

    def found(self) -> list[sa.ColumnElement[bool]]:
        """All conditions except state and verdict, by which the result is counted."""
        return [*self._there(), *self.narrowed()]

    def narrowed(self) -> list[sa.ColumnElement[bool]]:
        """All conditions except state and verdict, for removed and listed runs."""
        conditions = [_contains(word) for word in self.q.split()[:MOST_WORDS]]
        if self.tag:
            tags = sa.cast(Run.tags, sa.Text)
            conditions.append(sa.or_(*(tags.contains(json.dumps(tag), autoescape=True) for tag in self.tag)))
        conditions += labels.conditions(self.label)
        if self.campaign:
            named = sa.select(CampaignRow.digest).where(CampaignRow.name.in_(self.campaign))
            conditions.append(Run.campaign_digest.in_(named))
        if self.owner:
            conditions.append(sa.or_(Run.owner.in_(self.owner), Run.token.in_(self.owner)))
        if self.method:
            conditions.append(Run.worst_method.in_(self.method))
        if self.since is not None:
            conditions.append(Run.created >= self.since)
        if self.until is not None:
            conditions.append(Run.created < self.until)
        if self.pinned is not None:
            conditions.append(Run.pinned == self.pinned)
        return conditions

    def _there(self) -> list[sa.ColumnElement[bool]]:
        """Listed, or removed but not purged."""
        if self.removed:
            return [Run.removed.is_not(None), Run.purged.is_(None)]
        return [Run.removed.is_(None)]


def labelled(texts: Sequence[str]) -> list[tuple[str, str]]:
    """Keys and values of labels; 422 with a sentence for anything else."""
    try:
        return [pair(text) for text in texts]
    except ValueError as error:
        raise RefusedError(422, "invalid-request", f"{error}", [Problem("label", "", f"{error}")]) from None


def _contains(word: str) -> sa.ColumnElement[bool]:
    columns = [Run.name, Run.owner, sa.func.coalesce(Run.token, ""), sa.cast(Run.tags, sa.Text), _printed_id()]
    named = sa.select(CampaignRow.digest).where(CampaignRow.name.icontains(word, autoescape=True))
    here = [column.icontains(word, autoescape=True) for column in columns]
    return sa.or_(*here, Run.campaign_digest.in_(named))


def _printed_id() -> sa.ColumnElement[str]:
    digits = sa.cast(Run.id, sa.String)
    padded = sa.func.substr("0000" + digits, sa.func.length(digits) + 1)
    return "R-" + sa.case((Run.id < 10_000, padded), else_=digits)
