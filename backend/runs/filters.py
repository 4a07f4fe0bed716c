"""What the run list is narrowed to, as conditions on its rows. Start reading at `Filters.conditions`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Run
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState

MOST_WORDS = 8
"""Words of a search that count; the others are left out."""


@dataclass(frozen=True)
class Filters:
    """What the list is narrowed to; lists are alternatives, an empty one is no condition. Times [s since 1970]."""

    q: str = ""
    state: Sequence[RunState] = ()
    verdict: Sequence[VerdictWord] = ()
    tag: Sequence[str] = ()
    campaign: Sequence[str] = ()
    """Names of campaigns."""
    owner: Sequence[str] = ()
    method: Sequence[str] = ()
    """Which found the worst case."""
    since: float | None = None
    until: float | None = None
    """Submitted from `since` on, and before `until`."""
    pinned: bool | None = None
    removed: bool = False
    """Those that were removed, instead of all others."""

    def conditions(self) -> list[sa.ColumnElement[bool]]:
        """Everything together."""
        found = self.found()
        if self.state:
            found.append(Run.state.in_(self.state))
        if self.verdict:
            found.append(Run.verdict.in_(self.verdict))
        return found

    def found(self) -> list[sa.ColumnElement[bool]]:
        """Everything but state and verdict, by which the found ones are counted."""
        return [*self._there(), *self.narrowed()]

    def narrowed(self) -> list[sa.ColumnElement[bool]]:
        """Everything but state and verdict, of removed runs and all others alike."""
        conditions = [_said(word) for word in self.q.split()[:MOST_WORDS]]
        if self.tag:
            tags = sa.cast(Run.tags, sa.Text)
            conditions.append(sa.or_(*(tags.contains(json.dumps(tag), autoescape=True) for tag in self.tag)))
        if self.campaign:
            named = sa.select(CampaignRow.digest).where(CampaignRow.name.in_(self.campaign))
            conditions.append(Run.campaign_digest.in_(named))
        for column, wanted in ((Run.owner, self.owner), (Run.worst_method, self.method)):
            if wanted:
                conditions.append(column.in_(wanted))
        if self.since is not None:
            conditions.append(Run.created >= self.since)
        if self.until is not None:
            conditions.append(Run.created < self.until)
        if self.pinned is not None:
            conditions.append(Run.pinned == self.pinned)
        return conditions

    def _there(self) -> list[sa.ColumnElement[bool]]:
        """In the lists, or removed from them and still to be restored."""
        if self.removed:
            return [Run.removed.is_not(None), Run.purged.is_(None)]
        return [Run.removed.is_(None)]


def _said(word: str) -> sa.ColumnElement[bool]:
    """The word is in a name, a tag, the owner or the number."""
    columns = [Run.name, Run.owner, sa.cast(Run.tags, sa.Text), _printed_id()]
    named = sa.select(CampaignRow.digest).where(CampaignRow.name.icontains(word, autoescape=True))
    here = [column.icontains(word, autoescape=True) for column in columns]
    return sa.or_(*here, Run.campaign_digest.in_(named))


def _printed_id() -> sa.ColumnElement[str]:
    digits = sa.cast(Run.id, sa.String)
    padded = sa.func.substr("0000" + digits, sa.func.length(digits) + 1)
    return "R-" + sa.case((Run.id < 10_000, padded), else_=digits)
