"""The orders of the run list, and the cursors that mark a position in them.

Keyset pagination, not offsets (Winand, "Paging Through Results", use-the-index-luke.com): a cursor names the last row's
pin, sort value and number. Pinned runs come first in every order.
"""

from __future__ import annotations

import base64
import binascii
import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run
from backend.http.errors import RefusedError
from backend.http.schema import LARGEST_WHOLE, unstorable_text
from campaigns import Problem

_CAMPAIGN = sa.select(CampaignRow.name).where(CampaignRow.digest == Run.campaign_digest).scalar_subquery()
VALUES: dict[str, sa.ColumnElement[Any]] = {
    "created": sa.type_coerce(Run.id, sa.Integer),  # run numbers follow the time of creation
    "started": sa.type_coerce(Run.started, sa.Double),
    "finished": sa.type_coerce(Run.finished, sa.Double),
    "duration": Run.finished - Run.started,
    "name": sa.type_coerce(sa.func.lower(Run.name), sa.String),
    "campaign": sa.type_coerce(sa.func.lower(_CAMPAIGN), sa.String),
    "owner": sa.type_coerce(Run.owner, sa.String),
    "tags": sa.type_coerce(sa.func.nullif(sa.cast(Run.tags, sa.Text), "[]"), sa.String),
    "state": sa.type_coerce(Run.state, sa.String),
    "verdict": sa.type_coerce(Run.verdict, sa.String),
    "method": sa.type_coerce(Run.worst_method, sa.String),
    "margin": Run.worst_cost - Run.threshold,
    "worst": sa.type_coerce(Run.worst_cost, sa.Double),
    "nominal": sa.type_coerce(Run.nominal_cost, sa.Double),
    "criterion": sa.type_coerce(Run.threshold, sa.Double),
    "bound": sa.type_coerce(Run.upper_bound, sa.Double),
    "evaluations": sa.type_coerce(Run.evaluations, sa.Integer),
    "failed": sa.type_coerce(Run.failed_evaluations, sa.Integer),
}
if TYPE_CHECKING:
    Sort = str
else:
    Sort = Literal[tuple(f"{down}{name}" for name in VALUES for down in ("", "-"))]
    """One of `VALUES`; with a minus, downwards."""
NEWEST: Sort = "-created"


@dataclass(frozen=True)
class Order:
    """By pin, if pins count, then by value with missing values last in both directions, then newest first."""

    sort: Sort
    pins: bool = True

    @property
    def value(self) -> sa.ColumnElement[Any]:
        return VALUES[self.sort.lstrip("-")]

    @property
    def columns(self) -> list[sa.ColumnElement[Any]]:
        down, first = self.sort.startswith("-"), [Run.pinned.desc()] if self.pins else []
        if self.sort.endswith("created"):
            return [*first, Run.id.desc() if down else Run.id.asc()]
        return [*first, self.value.is_(None), self.value.desc() if down else self.value.asc(), Run.id.desc()]

    def after(self, cursor: str) -> sa.ColumnElement[bool]:
        """The rows after the one named by the cursor; 422 for a cursor of another order."""
        pinned, value, run_id = self._decode(cursor)
        behind = self._after(value, run_id)
        if not self.pins:
            return behind
        if not pinned:
            return sa.and_(Run.pinned.is_(False), behind)
        return sa.or_(Run.pinned.is_(False), behind)

    def _after(self, value: Any, run_id: int) -> sa.ColumnElement[bool]:
        down = self.sort.startswith("-")
        if self.sort.endswith("created"):
            return Run.id < run_id if down else Run.id > run_id
        if value is None:
            return sa.and_(self.value.is_(None), Run.id < run_id)
        further = self.value < value if down else self.value > value
        return sa.or_(further, sa.and_(self.value == value, Run.id < run_id), self.value.is_(None))

    def cursor(self, row: Any) -> str:
        """The cursor of a row, from its `pinned`, `value` and `id`."""
        text = json.dumps([self.sort, bool(row.pinned), row.value, row.id])
        return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")

    def _decode(self, cursor: str) -> tuple[bool, Any, int]:
        try:
            text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True)
            of, pinned, value, run_id = json.loads(text)
        except (binascii.Error, ValueError, TypeError, RecursionError):
            raise _bad(cursor, "unknown cursor; start again without a cursor") from None
        if of != self.sort:
            message = f"from a list sorted by {of}, this one is sorted by {self.sort}; start again without a cursor"
            raise _bad(cursor, message)
        known = isinstance(run_id, int) and not isinstance(run_id, bool) and 0 <= run_id < 2**62
        if not (self._fits(value) and known and isinstance(pinned, bool)):
            raise _bad(cursor, "unknown cursor; start again without a cursor")
        return pinned, value, run_id

    def _fits(self, value: Any) -> bool:
        """Whether rows of this order can have the value, and the database can compare with it."""
        if value is None or isinstance(value, bool):
            return value is None
        if isinstance(self.value.type, sa.String):
            return isinstance(value, str) and unstorable_text(value) is None
        if isinstance(value, int):
            return abs(value) <= LARGEST_WHOLE
        return isinstance(value, float) and not math.isnan(value)


def _bad(cursor: str, message: str) -> RefusedError:
    problem = Problem("cursor", cursor[:120], message)
    return RefusedError("bad-cursor", str(problem), [problem])
